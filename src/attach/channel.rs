//! How debugger and solver exchange lines: standard streams, one inherited socket, or a socket to which the solver connects.

use std::fmt;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::ChildStdin;
use std::time::Duration;
use stickslip_platform::local_socket::{self, LocalListener, LocalStream};
use stickslip_platform::{disk, process, random};

/// Longest wait of a single write to a socket.
const WRITE: Duration = Duration::from_millis(10);
/// Time for a TCP connection to send its token.
const INTRODUCTION: Duration = Duration::from_secs(2);
/// Environment variables of a started solver: the address, and the token of a TCP connection.
const ADDRESS: &str = "STICKSLIP_CONNECT";
const TOKEN: &str = "STICKSLIP_TOKEN";

/// How messages are exchanged.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Channel {
    /// Standard input and output of the solver.
    #[default]
    Streams,
    /// One socket as standard input, for both directions; standard output goes to the log.
    Inherited,
    /// The solver connects to a socket in the file system.
    Unix(PathBuf),
    /// The solver connects to a port, and sends the token as its first line.
    Tcp {
        /// Host and port.
        address: String,
        /// The token.
        token: String,
    },
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Channel::Streams => f.write_str("standard streams"),
            Channel::Inherited => f.write_str("fd:0"),
            Channel::Unix(path) => write!(f, "unix:{}", path.display()),
            Channel::Tcp { address, .. } => write!(f, "tcp:{address}"),
        }
    }
}

impl Channel {
    /// Parses `fd:0`, `unix:PATH`, `tcp:PORT` or `tcp:HOST:PORT`; without a host the port is local.
    ///
    /// # Errors
    /// What is expected, or why no token can be made.
    pub fn parse(text: &str) -> Result<Channel, String> {
        let expected = || "expected unix:PATH, tcp:PORT, tcp:HOST:PORT or fd:0".to_owned();
        match text.split_once(':') {
            Some(("fd", "0")) => Ok(Channel::Inherited),
            Some(("unix", path)) if !path.is_empty() => Ok(Channel::Unix(path.into())),
            Some(("tcp", address)) => {
                let address = match address.parse::<u16>() {
                    Ok(port) => format!("127.0.0.1:{port}"),
                    Err(_) if address.contains(':') => address.to_owned(),
                    Err(_) => return Err(expected()),
                };
                let token = token().map_err(|error| format!("no token can be made: {error}"))?;
                Ok(Channel::Tcp { address, token })
            }
            _ => Err(expected()),
        }
    }

    /// Whether only this machine can connect.
    pub fn is_local(&self) -> bool {
        match self {
            Channel::Tcp { address, .. } => {
                let host = address
                    .rsplit_once(':')
                    .map_or("", |(host, _)| host)
                    .trim_matches(['[', ']']);
                let ip = host.parse::<std::net::IpAddr>();
                host == "localhost" || ip.is_ok_and(|ip| ip.is_loopback())
            }
            _ => true,
        }
    }

    /// What a solver that connects needs to know, in words.
    pub fn invitation(&self) -> String {
        let set: String = self
            .environment()
            .into_iter()
            .map(|(name, value)| format!(" {name}={value}"))
            .collect();
        format!("waiting for a solver; start it with{set}")
    }

    /// The environment of a started solver.
    pub(super) fn environment(&self) -> Vec<(&'static str, String)> {
        match self {
            Channel::Streams => Vec::new(),
            Channel::Tcp { token, .. } => {
                vec![(ADDRESS, self.to_string()), (TOKEN, token.clone())]
            }
            _ => vec![(ADDRESS, self.to_string())],
        }
    }

    /// Starts to wait for a connection; `None` if there is none to wait for.
    pub(super) fn listen(&self) -> io::Result<Option<Listener>> {
        Ok(match self {
            Channel::Streams | Channel::Inherited => None,
            Channel::Unix(path) => {
                let listener = local_socket::bind(path)?;
                listener.set_nonblocking(true)?;
                Some(Listener::Unix(listener, path.clone()))
            }
            Channel::Tcp { address, token } => {
                let listener = TcpListener::bind(address)?;
                listener.set_nonblocking(true)?;
                Some(Listener::Tcp(listener, token.clone()))
            }
        })
    }
}

/// The token of this program: that of the environment, or 32 random digits.
fn token() -> io::Result<String> {
    if let Some(token) = std::env::var(TOKEN).ok().filter(|token| !token.is_empty()) {
        return Ok(token);
    }
    Ok(random::bytes::<16>()?
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect())
}

/// Waits for a connection.
pub(super) enum Listener {
    Unix(LocalListener, PathBuf),
    Tcp(TcpListener, String),
}

impl Listener {
    /// A connection that has arrived; `None` if there is none, or its token was wrong.
    pub(super) fn accept(&self) -> io::Result<Option<Input>> {
        let input = match self {
            Listener::Unix(listener, _) => listener.accept().map(|(stream, _)| Input::Unix(stream)),
            Listener::Tcp(listener, token) => listener.accept().and_then(|(stream, _)| {
                stream.set_nonblocking(false)?;
                introduced(&stream, token)?;
                stream.set_nodelay(true)?;
                Ok(Input::Tcp(stream))
            }),
        };
        match input {
            Ok(input) => Ok(Some(input)),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(None),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        if let Listener::Unix(_, path) = self {
            // The name of a socket that nobody listens to.
            let _ = disk::remove_file(path);
        }
    }
}

/// Checks the first line of a connection.
fn introduced(mut stream: &TcpStream, token: &str) -> io::Result<()> {
    stream.set_read_timeout(Some(INTRODUCTION))?;
    let mut line = Vec::new();
    let mut letter = [0];
    while line.len() <= token.len() && stream.read(&mut letter)? == 1 && letter != [b'\n'] {
        line.extend(letter);
    }
    stream.set_read_timeout(None)?;
    // All letters are compared, so that the duration reveals nothing.
    let differs = line
        .iter()
        .zip(token.as_bytes())
        .fold(0, |sum, (a, b)| sum | (a ^ b));
    if line.len() == token.len() && differs == 0 {
        Ok(())
    } else {
        Err(io::ErrorKind::PermissionDenied.into())
    }
}

/// The debugger's end of the connection. Writing waits for a short time at most.
pub(super) enum Input {
    Pipe(ChildStdin),
    Unix(LocalStream),
    Tcp(TcpStream),
}

impl Input {
    /// A socket, with blocking reads and writes that give up soon.
    pub(super) fn prepared(self) -> io::Result<Input> {
        match &self {
            Input::Pipe(pipe) => process::set_nonblocking(pipe)?,
            Input::Unix(stream) => {
                stream.set_nonblocking(false)?;
                stream.set_write_timeout(Some(WRITE))?;
            }
            Input::Tcp(stream) => stream.set_write_timeout(Some(WRITE))?,
        }
        Ok(self)
    }

    /// The same connection for reading; `None` for a pipe.
    pub(super) fn reader(&self) -> io::Result<Option<Box<dyn Read + Send>>> {
        Ok(match self {
            Input::Pipe(_) => None,
            Input::Unix(stream) => Some(Box::new(stream.try_clone()?)),
            Input::Tcp(stream) => Some(Box::new(stream.try_clone()?)),
        })
    }
}

impl Drop for Input {
    /// Also ends the thread that reads.
    fn drop(&mut self) {
        let _ = match self {
            Input::Pipe(_) => Ok(()),
            Input::Unix(stream) => stream.shutdown(Shutdown::Both),
            Input::Tcp(stream) => stream.shutdown(Shutdown::Both),
        };
    }
}

impl Write for Input {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Input::Pipe(pipe) => pipe.write(bytes),
            Input::Unix(stream) => stream.write(bytes),
            Input::Tcp(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_a_path_a_port_or_the_inherited_socket() {
        assert_eq!(Channel::parse("fd:0"), Ok(Channel::Inherited));
        assert_eq!(
            Channel::parse("unix:/a b"),
            Ok(Channel::Unix("/a b".into()))
        );
        for (text, shown, local) in [
            ("tcp:80", "tcp:127.0.0.1:80", true),
            ("tcp:localhost:80", "tcp:localhost:80", true),
            ("tcp:[::1]:80", "tcp:[::1]:80", true),
            ("tcp:0.0.0.0:80", "tcp:0.0.0.0:80", false),
            ("tcp:example.org:80", "tcp:example.org:80", false),
        ] {
            let channel = Channel::parse(text).expect(text);
            assert_eq!(
                (channel.to_string().as_str(), channel.is_local()),
                (shown, local)
            );
            let Channel::Tcp { token, .. } = channel else {
                panic!("{text}");
            };
            assert!(token.len() >= 16, "{token}");
        }
        for text in ["", "unix:", "tcp:", "tcp:x", "fd:1", "pipe:a"] {
            assert!(Channel::parse(text).is_err(), "{text}");
        }
    }
}
