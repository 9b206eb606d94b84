//! Byte streams that never block: sockets, serial lines, pseudo-terminals.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::path::Path;
use std::time::Duration;

use rustix::fs::{FlockOperation, Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::{self, OptionalActions, QueueSelector};

/// How long a robot or a scanner may take to accept a connection.
pub const CONNECT: Duration = Duration::from_millis(1000);

/// A stream of bytes in both directions.
pub trait Link {
    /// Reads what has arrived, possibly nothing.
    ///
    /// # Errors
    /// The other end is gone.
    fn read(&mut self, out: &mut Vec<u8>) -> io::Result<()>;

    /// Writes as much as goes without waiting and returns how much that was.
    ///
    /// # Errors
    /// The other end is gone.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;
}

/// Any non-blocking file or socket.
#[derive(Debug)]
pub struct Stream<S>(S);

impl<S: Read + Write> Link for Stream<S> {
    fn read(&mut self, out: &mut Vec<u8>) -> io::Result<()> {
        let mut room = [0; 4096];
        // A flood must not keep the caller from its deadline.
        for _ in 0..16 {
            match self.0.read(&mut room) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(count) => out.extend_from_slice(room.get(..count).unwrap_or_default()),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Ok(count) => Ok(count),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(0),
            Err(error) if error.kind() == ErrorKind::Interrupted => Ok(0),
            Err(error) => Err(error),
        }
    }
}

/// Connects to `address`, for instance `127.0.0.1:8101`, within `most`.
///
/// # Errors
/// Nobody listens there, or nobody answers in time.
pub fn tcp(address: &str, most: Duration) -> io::Result<Stream<TcpStream>> {
    let mut failed = io::Error::new(ErrorKind::NotFound, "no such host");
    for place in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&place, most) {
            Ok(stream) => return accepted(stream),
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

/// A socket somebody has accepted.
///
/// # Errors
/// It cannot be switched to non-blocking.
pub fn accepted(stream: TcpStream) -> io::Result<Stream<TcpStream>> {
    stream.set_nodelay(true)?;
    stream.set_nonblocking(true)?;
    Ok(Stream(stream))
}

/// Listens on `address` without blocking.
///
/// # Errors
/// The address is taken or not ours.
pub fn listen(address: &str) -> io::Result<TcpListener> {
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// Opens a serial line or a pseudo-terminal for this process alone, raw, 8N1, at `baud`. What waited
/// in it was meant for somebody else and is thrown away.
///
/// # Errors
/// It does not exist, is no terminal, is held by another process, or does not know the speed.
pub fn serial(path: &Path, baud: u32) -> io::Result<Stream<File>> {
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let file = rustix::fs::open(path, flags, Mode::empty())?;
    // Two hosts on one line would mix their bytes. The lock holds back those that ask for one, the
    // exclusive mode everybody but root; it ends with the last file on the line.
    let busy = |_| io::Error::new(ErrorKind::ResourceBusy, "another program holds it");
    rustix::fs::flock(&file, FlockOperation::NonBlockingLockExclusive).map_err(busy)?;
    termios::tcgetattr(&file)?;
    termios::ioctl_tiocexcl(&file)?;
    termios::tcflush(&file, QueueSelector::IOFlush)?;
    let mut settings = termios::tcgetattr(&file)?;
    settings.make_raw();
    settings.set_speed(baud)?;
    termios::tcsetattr(&file, OptionalActions::Now, &settings)?;
    Ok(Stream(File::from(file)))
}

/// Makes a pseudo-terminal; returns our end and the path of the other.
///
/// # Errors
/// The system has none left.
pub fn pseudo_terminal() -> io::Result<(Stream<File>, String)> {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
    let ours = rustix::pty::openpt(flags)?;
    rustix::pty::grantpt(&ours)?;
    rustix::pty::unlockpt(&ours)?;
    let name = rustix::pty::ptsname(&ours, Vec::new())?;
    let name = name.to_string_lossy().into_owned();
    let mut settings = termios::tcgetattr(&ours)?;
    settings.make_raw();
    termios::tcsetattr(&ours, OptionalActions::Now, &settings)?;
    let status = rustix::fs::fcntl_getfl(&ours)?;
    rustix::fs::fcntl_setfl(&ours, status | OFlags::NONBLOCK)?;
    Ok((Stream(File::from(ours)), name))
}

/// Opens what a person wrote as a port: `tcp:HOST:PORT`, or a path of a serial line.
///
/// # Errors
/// As [`tcp`] and [`serial`]; the message names the port and what to write.
pub fn open(port: &str, baud: u32) -> io::Result<Box<dyn Link>> {
    let result: io::Result<Box<dyn Link>> = match port.strip_prefix("tcp:") {
        Some(address) => tcp(address, CONNECT).map(|link| Box::new(link) as Box<dyn Link>),
        None => serial(Path::new(port), baud).map(|link| Box::new(link) as Box<dyn Link>),
    };
    result.map_err(|error| {
        let advice = "write tcp:HOST:PORT, or the path of a serial line such as /dev/ttyUSB0";
        io::Error::new(
            error.kind(),
            format!("cannot open port {port}: {error}; {advice}"),
        )
    })
}
