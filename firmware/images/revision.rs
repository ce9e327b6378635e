// Included by build scripts: which commit a release is made of.

/// Sixteen digits in `TAUTLINE_REVISION`; none where it is not a release, or not a checkout.
fn tell_revision() {
    let git = |arguments: &[&str]| {
        let output = std::process::Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    let is_release = std::env::var("PROFILE").as_deref() == Ok("release");
    let head = is_release.then(|| git(&["rev-parse", "HEAD"])).flatten();
    let revision = head.as_deref().and_then(|head| head.get(..16)).unwrap_or_default();
    println!("cargo:rustc-env=TAUTLINE_REVISION={revision}");
    // Only a release is made anew for each commit.
    if is_release
        && let Some(log) = git(&["rev-parse", "--path-format=absolute", "--git-path", "logs/HEAD"])
    {
        println!("cargo:rerun-if-changed={log}");
    }
}
