//! A live client over a real socket, which checks every message against `openapi.yaml`. The tests of live runs are in `live.rs`.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use equipoise::api::App;
use equipoise::config::Config;
use equipoise::{router, transport};
use futures_util::{SinkExt, StreamExt};
use serde_json::{Value, json};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{WebSocketStream, client_async};

use super::contract;

pub(crate) const SOON: Duration = Duration::from_secs(20);

/// A server on a free port.
pub(crate) async fn start() -> (App, SocketAddr) {
    start_with(&Config::default()).await
}

pub(crate) async fn start_with(config: &Config) -> (App, SocketAddr) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let app = App::new(config);
    let serving = app.clone();
    tokio::spawn(async move {
        let limits = serving.config.limits;
        transport::serve(listener, router::router(serving), &limits, std::future::pending()).await;
    });
    (app, address)
}

pub(crate) struct Client {
    pub(crate) socket: WebSocketStream<TcpStream>,
    /// Rows of a message that are not consumed yet.
    pub(crate) rows: Vec<Row>,
}

/// Numbers of an impact by column name.
pub(crate) type Row = BTreeMap<String, Value>;

pub(crate) async fn try_open(
    address: SocketAddr,
    url: &str,
    headers: &[(&'static str, &str)],
) -> Result<(Client, Option<String>), Error> {
    let mut request = format!("ws://{address}{url}").into_client_request().unwrap();
    for (name, value) in headers {
        request.headers_mut().insert(*name, value.parse().unwrap());
    }
    let stream = TcpStream::connect(address).await.unwrap();
    let (socket, response) = client_async(request, stream).await?;
    let protocol = response.headers().get("sec-websocket-protocol").map(|value| value.to_str().unwrap().to_owned());
    Ok((Client { socket, rows: vec![] }, protocol))
}

pub(crate) async fn open(address: SocketAddr, url: &str) -> Client {
    try_open(address, url, &[]).await.unwrap().0
}

/// The problem document of a refused handshake.
pub(crate) async fn refused(address: SocketAddr, url: &str, headers: &[(&'static str, &str)]) -> Value {
    match try_open(address, url, headers).await {
        Err(Error::Http(response)) => {
            let status = response.status().as_u16();
            let problem: Value = serde_json::from_slice(response.body().as_ref().unwrap()).unwrap();
            assert_eq!(problem["status"], status);
            problem
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("{url} was not refused"),
    }
}

/// The problem of an address that is not a valid run: the only message, before a close with 1008.
pub(crate) async fn no_run(address: SocketAddr, url: &str) -> Value {
    let mut client = open(address, url).await;
    let problem = client.next().await;
    assert_eq!(problem["type"], "problem", "{url}");
    assert_eq!(client.hear().await.unwrap_err(), Some(1008), "{url}");
    problem
}

impl Client {
    pub(crate) async fn send(&mut self, message: Value) {
        self.socket.send(Message::text(message.to_string())).await.unwrap();
    }

    /// The next text; `None` after the server's close, with its code.
    pub(crate) async fn hear(&mut self) -> Result<Value, Option<u16>> {
        loop {
            match timeout(SOON, self.socket.next()).await.expect("the server is silent") {
                Some(Ok(Message::Text(text))) => return Ok(held(&text)),
                Some(Ok(Message::Close(frame))) => return Err(frame.map(|frame| frame.code.into())),
                Some(Ok(_)) => {}
                None | Some(Err(_)) => return Err(None),
            }
        }
    }

    pub(crate) async fn next(&mut self) -> Value {
        self.hear().await.expect("the server has closed")
    }

    /// The next message of a type; skips others.
    pub(crate) async fn next_of(&mut self, kind: &str) -> Value {
        loop {
            let message = self.next().await;
            if message["type"] == kind {
                return message;
            }
            self.keep(&message);
        }
    }

    pub(crate) async fn ask(&mut self, message: Value) -> Value {
        let of = message["type"].clone();
        self.send(message).await;
        let ack = self.next_of("ack").await;
        assert_eq!(ack["of"], of);
        ack
    }

    fn keep(&mut self, message: &Value) {
        self.rows.extend(impacts_in(message));
    }

    /// `count` impacts, from single or gathered messages; fewer if the run ends.
    pub(crate) async fn impacts(&mut self, count: usize) -> Vec<Row> {
        while self.rows.len() < count {
            let message = self.next().await;
            self.keep(&message);
            if message["type"] == "end" {
                break;
            }
        }
        let count = count.min(self.rows.len());
        self.rows.drain(..count).collect()
    }

    pub(crate) async fn closed(&mut self) -> Option<u16> {
        loop {
            match self.hear().await {
                Ok(_) => {}
                Err(code) => return code,
            }
        }
    }
}

/// A message, checked against the contract.
pub(crate) fn held(text: &str) -> Value {
    let message: Value = serde_json::from_str(text).unwrap();
    let name = message["type"].as_str().unwrap();
    let name = format!("#/components/schemas/Live{}{}", name[..1].to_uppercase(), &name[1..]);
    let faults = contract::faults(&json!({"$ref": name}), &message);
    assert!(faults.is_empty(), "{faults:?} in {text}");
    message
}

/// The impacts of a message; mostly none.
pub(crate) fn impacts_in(message: &Value) -> Vec<Row> {
    match message["type"].as_str() {
        Some("impact") => vec![row(message)],
        Some("impacts") => rows(message),
        _ => vec![],
    }
}

/// The columns of an impact.
fn row(impact: &Value) -> Row {
    let members =
        impact.as_object().unwrap().iter().filter(|(name, _)| !["type", "next_strike"].contains(&name.as_str()));
    members.map(|(name, value)| (name.clone(), value.clone())).collect()
}

fn rows(message: &Value) -> Vec<Row> {
    let columns = message["columns"].as_object().unwrap();
    let count = columns["n"].as_array().unwrap().len();
    let cell = |index: usize| columns.iter().map(move |(name, cells)| (name.clone(), cells[index].clone())).collect();
    (0..count).map(cell).collect()
}

pub(crate) fn numbers(rows: &[Row]) -> Vec<u64> {
    rows.iter().map(|row| row["n"].as_u64().unwrap()).collect()
}

pub(crate) fn now_ms() -> u64 {
    u64::try_from(SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_millis()).unwrap()
}
