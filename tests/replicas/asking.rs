//! An HTTP/1.1 client that can tell a whole answer from a cut one.

use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};

use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::net::{TcpSocket, TcpStream};
use tokio::time::timeout;

use crate::support::socket::SOON;

/// A request.
#[derive(Debug, Clone)]
pub(crate) struct Ask {
    pub(crate) method: &'static str,
    pub(crate) target: String,
    pub(crate) headers: String,
    pub(crate) body: String,
    /// Local source address.
    pub(crate) from: Ipv4Addr,
}

impl Ask {
    pub(crate) fn get(target: impl Into<String>) -> Self {
        let (headers, body) = (String::new(), String::new());
        Self { method: "GET", target: target.into(), headers, body, from: Ipv4Addr::LOCALHOST }
    }

    pub(crate) fn post(target: &str, body: &str) -> Self {
        let ask = Self { method: "POST", body: body.to_owned(), ..Self::get(target) };
        ask.with("content-type", "application/json")
    }

    pub(crate) fn with(mut self, name: &str, value: &str) -> Self {
        self.headers += &format!("{name}: {value}\r\n");
        self
    }

    pub(crate) fn from(mut self, last: u8) -> Self {
        self.from = Ipv4Addr::new(127, 0, 0, last);
        self
    }
}

/// A whole answer.
#[derive(Debug, Clone)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) headers: BTreeMap<String, String>,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    /// The part of an answer that all replicas share.
    pub(crate) fn lasting(&self) -> (u16, [Option<&String>; 3], Shown<'_>) {
        let headers = ["etag", "content-type", "content-encoding"].map(|name| self.headers.get(name));
        (self.status, headers, Shown(&self.body))
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&self.body)))
    }
}

/// Bytes of which a failed test shows only the beginning.
#[derive(PartialEq)]
pub(crate) struct Shown<'a>(&'a [u8]);

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let begin = String::from_utf8_lossy(&self.0[..self.0.len().min(200)]);
        write!(formatter, "{} bytes: {begin}", self.0.len())
    }
}

/// Reason for a missing answer.
#[derive(Debug)]
pub(crate) enum Failed {
    /// No answer at all.
    Unanswered(String),
    /// A head, but not the whole body.
    Cut,
}

/// An answer whose head has arrived.
pub(crate) struct Begun {
    pub(crate) status: u16,
    pub(crate) headers: BTreeMap<String, String>,
    rest: BufReader<TcpStream>,
    is_head: bool,
    left: Option<usize>,
}

/// Sends a request and reads the head of the answer.
pub(crate) async fn begin(to: SocketAddr, ask: &Ask) -> io::Result<Begun> {
    let socket = TcpSocket::new_v4()?;
    socket.bind((IpAddr::from(ask.from), 0).into())?;
    let mut socket = socket.connect(to).await?;
    let Ask { method, target, headers, body, .. } = ask;
    let length = if body.is_empty() { String::new() } else { format!("content-length: {}\r\n", body.len()) };
    let head = format!("{method} {target} HTTP/1.1\r\nhost: {to}\r\nconnection: close\r\n{headers}{length}\r\n");
    // A refusal may come before the whole request is sent.
    let _ = socket.write_all(format!("{head}{body}").as_bytes()).await;
    let mut rest = BufReader::new(socket);
    let first = line(&mut rest).await?;
    let status = first.split(' ').nth(1).and_then(|status| status.parse().ok());
    let status = status.ok_or_else(|| io::Error::other(format!("no status in {first:?}")))?;
    let mut headers = BTreeMap::new();
    loop {
        let line = line(&mut rest).await?;
        let Some((name, value)) = line.split_once(": ") else { break };
        headers.insert(name.to_ascii_lowercase(), value.to_owned());
    }
    let left = headers.get("content-length").map(|length| length.parse().unwrap());
    Ok(Begun { status, headers, rest, is_head: *method == "HEAD" || status == 304 || status == 204, left })
}

impl Begun {
    /// The next piece of the body; `None` at its end.
    pub(crate) async fn piece(&mut self) -> io::Result<Option<Vec<u8>>> {
        if self.is_head {
            return Ok(None);
        }
        let length = match self.left.take() {
            Some(length) => {
                self.is_head = true;
                length
            }
            None => {
                let size = line(&mut self.rest).await?;
                usize::from_str_radix(&size, 16).map_err(|_| io::Error::other(format!("no chunk: {size:?}")))?
            }
        };
        let mut piece = vec![0; length];
        timeout(3 * SOON, self.rest.read_exact(&mut piece)).await.expect("the server is silent")?;
        if self.is_head {
            return Ok(Some(piece));
        }
        line(&mut self.rest).await?;
        Ok(Some(piece).filter(|piece| !piece.is_empty()))
    }

    /// The rest of the body.
    pub(crate) async fn whole(mut self) -> Result<Answer, Failed> {
        let mut body = Vec::new();
        while let Some(piece) = self.piece().await.map_err(|_| Failed::Cut)? {
            body.extend(piece);
        }
        Ok(Answer { status: self.status, headers: self.headers, body })
    }
}

/// A line without its end; an error if the connection ends before it.
async fn line(from: &mut BufReader<TcpStream>) -> io::Result<String> {
    let mut line = String::new();
    timeout(3 * SOON, from.read_line(&mut line)).await.expect("the server is silent")?;
    line.strip_suffix("\r\n").map(str::to_owned).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
}

/// The whole answer to a request.
pub(crate) async fn ask(to: SocketAddr, ask: &Ask) -> Result<Answer, Failed> {
    begin(to, ask).await.map_err(|error| Failed::Unanswered(error.to_string()))?.whole().await
}
