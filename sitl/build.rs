//! Tells the simulator which commit it is made of.

include!("../firmware/images/revision.rs");

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    tell_revision();
}
