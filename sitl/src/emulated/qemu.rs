//! QEMU's STM32F405, as a child process in a folder of its own.

use super::pipe::Pipe;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

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

/// Longest until an image asks for its first bus transaction.
const BOOT: Duration = Duration::from_secs(30);

/// Whether a file is an ELF of 32 bits, little-endian, for ARM: by its first bytes.
fn recognise(image: &Path) -> io::Result<()> {
    const ARM: u8 = 40;
    let mut head = [0; 20];
    let whole = File::open(image).and_then(|mut file| file.read_exact(&mut head));
    let is_image =
        head.starts_with(b"\x7fELF\x01\x01") && head.get(18..) == Some([ARM, 0].as_slice());
    if whole.is_ok() && is_image {
        return Ok(());
    }
    Err(io::Error::other(format!(
        "{}: no ARM image (cargo xtask emulate builds one)",
        image.display()
    )))
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
        recognise(&image)?;
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
        let mut qemu = Self { child, folder: folder.to_owned() };
        let boot = if telemetry == Telemetry::None { BOOT } else { Duration::MAX };
        let (request, reply) = qemu.meet(request, reply, boot)?;
        Ok((qemu, Pipe::new(request, reply)))
    }

    /// Opens the FIFOs, for which the image opens them too. One that is none of ours never does.
    fn meet(
        &mut self,
        request: PathBuf,
        reply: PathBuf,
        boot: Duration,
    ) -> io::Result<(File, File)> {
        let (send, opened) = mpsc::channel();
        std::thread::spawn(move || {
            // In the order in which the image opens them; each waits for the other side.
            let open = || {
                let request = OpenOptions::new().read(true).open(request)?;
                Ok((request, OpenOptions::new().write(true).open(reply)?))
            };
            let _ = send.send(open());
        });
        let began = Instant::now();
        loop {
            if let Ok(opened) = opened.recv_timeout(Duration::from_millis(50)) {
                return opened;
            }
            if let Some(status) = self.child.try_wait()? {
                return Err(io::Error::other(format!("QEMU could not run the image: {status}")));
            }
            if began.elapsed() > boot {
                return Err(io::Error::other(format!(
                    "the image asks for nothing within {} s: built without the feature `emulated`?",
                    boot.as_secs()
                )));
            }
        }
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
