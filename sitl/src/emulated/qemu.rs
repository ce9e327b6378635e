//! QEMU's STM32F405, as a child process in a folder of its own.

use super::pipe::Pipe;
use std::fs::{self, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

const PROGRAM: &str = "qemu-system-arm";
const MACHINE: &str = "netduinoplus2";

/// Where the image's USART1 goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Telemetry {
    /// Nowhere.
    None,
    /// A TCP port on this machine, which waits for a client before the image starts.
    Tcp(u16),
}

/// A running emulator.
#[derive(Debug)]
pub struct Qemu {
    child: Child,
    folder: PathBuf,
}

/// Keeps this process and its children on one core. Board and host never run at once, and a core that has gone idle
/// takes far longer to wake than to switch.
fn share_a_core() {
    #[cfg(target_os = "linux")]
    {
        use nix::sched::{CpuSet, sched_getcpu, sched_setaffinity};
        let mut set = CpuSet::new();
        let here = sched_getcpu().and_then(|core| set.set(core));
        // Slower without, no worse.
        let _ = here.and_then(|()| sched_setaffinity(nix::unistd::Pid::from_raw(0), &set));
    }
}

fn fifo(path: &Path) -> io::Result<()> {
    let made = Command::new("mkfifo").arg(path).status()?;
    if made.success() {
        Ok(())
    } else {
        Err(io::Error::other(format!("mkfifo {}", path.display())))
    }
}

impl Qemu {
    /// Starts an image. With `counts` its clock counts instructions, and two runs are alike to the byte.
    ///
    /// # Errors
    /// When QEMU is missing or does not start.
    pub fn start(
        image: &Path,
        folder: &Path,
        telemetry: Telemetry,
        counts: bool,
    ) -> io::Result<(Self, Pipe)> {
        let image = image.canonicalize().map_err(|e| {
            io::Error::other(format!("{}: {e} (cargo xtask emulate builds it)", image.display()))
        })?;
        let _ = fs::remove_dir_all(folder);
        fs::create_dir_all(folder)?;
        let (request, reply) = (folder.join("request"), folder.join("reply"));
        fifo(&request)?;
        fifo(&reply)?;
        let serial = match telemetry {
            Telemetry::None => "null".to_owned(),
            Telemetry::Tcp(port) => {
                format!("tcp:127.0.0.1:{port},server=on,wait=on,nodelay=on")
            }
        };
        share_a_core();
        let mut command = Command::new(PROGRAM);
        command
            .args(["-M", MACHINE, "-nographic", "-monitor", "none", "-serial", &serial])
            .args(["-semihosting-config", "enable=on,target=native"])
            .arg("-kernel")
            .arg(image)
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null());
        if counts {
            command.args(["-icount", "shift=0"]);
        }
        let child = command
            .spawn()
            .map_err(|e| io::Error::other(format!("{PROGRAM}: {e} (Debian: qemu-system-arm)")))?;
        let qemu = Self { child, folder: folder.to_owned() };
        // In the order in which the image opens them; each waits for the other side.
        let request = OpenOptions::new().read(true).open(request)?;
        let reply = OpenOptions::new().write(true).open(reply)?;
        Ok((qemu, Pipe::new(request, reply)))
    }

    /// Waits for the image to end it.
    ///
    /// # Errors
    /// When it ended badly.
    pub fn finish(mut self) -> io::Result<()> {
        let status = self.child.wait()?;
        if status.success() { Ok(()) } else { Err(io::Error::other(format!("QEMU: {status}"))) }
    }

    /// Its folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        // Already gone after a good end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
