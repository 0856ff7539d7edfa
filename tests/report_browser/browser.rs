//! A real browser for tests: chromedriver's plain HTTP protocol (WebDriver) over a socket, no dependency.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// A browser with one window whose every request to a network goes to a proxy that notes it and answers nothing.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
    proxy: Proxy,
    // Removed with the browser.
    profile: tempfile::TempDir,
}

/// Where a program is: named by an environment variable, or on the path.
fn program(variable: &str, name: &str) -> Option<PathBuf> {
    if let Some(named) = std::env::var_os(variable) {
        return Some(named.into());
    }
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path)
        .map(|folder| folder.join(name))
        .find(|file| file.is_file())
}

impl Browser {
    /// Starts one; `None`, with a message, where chromium or chromedriver is missing.
    pub fn start() -> Option<Self> {
        let (Some(chromium), Some(chromedriver)) = (
            program("CHROMIUM", "chromium"),
            program("CHROMEDRIVER", "chromedriver"),
        ) else {
            println!(
                "skipped: needs chromium and chromedriver (Debian: chromium, chromium-driver; or CHROMIUM and CHROMEDRIVER)"
            );
            return None;
        };
        let mut driver = Command::new(chromedriver)
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromedriver starts");
        let mut lines = BufReader::new(driver.stdout.take().expect("stdout is piped")).lines();
        let port = lines
            .by_ref()
            .map_while(Result::ok)
            .find_map(|line| {
                line.split("successfully on port ")
                    .nth(1)?
                    .trim_end_matches('.')
                    .parse()
                    .ok()
            })
            .expect("chromedriver says its port");
        // Keep reading, or the driver blocks once the pipe is full.
        std::thread::spawn(move || lines.for_each(drop));

        let proxy = Proxy::start();
        let profile = tempfile::tempdir().expect("a temporary folder");
        let mut browser = Self {
            driver,
            port,
            session: String::new(),
            proxy,
            profile,
        };
        let options: Vec<String> = [
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-default-apps",
            "--disable-extensions",
            "--disable-sync",
            "--window-size=1000,900",
            // Without this, addresses of this machine would bypass the proxy.
            "--proxy-bypass-list=<-loopback>",
        ]
        .into_iter()
        .map(String::from)
        .chain([
            format!("--proxy-server=127.0.0.1:{}", browser.proxy.port),
            format!("--user-data-dir={}", browser.profile.path().display()),
        ])
        .collect();
        let wanted = json!({ "capabilities": { "alwaysMatch": {
            "browserName": "chrome",
            "goog:chromeOptions": { "binary": chromium, "args": options },
            "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
            "unhandledPromptBehavior": "ignore",
        } } });
        let session = browser.call("POST", "/session", &wanted);
        session["sessionId"]
            .as_str()
            .expect("a session")
            .clone_into(&mut browser.session);
        // What the browser's own first page asks and says is no concern of a test.
        browser.post("/url", &json!({ "url": "about:blank" }));
        browser.asked();
        browser.console();
        Some(browser)
    }

    /// Opens a file.
    pub fn open(&self, file: &Path) {
        self.post(
            "/url",
            &json!({ "url": format!("file://{}", file.display()) }),
        );
    }

    /// Runs `script` as the body of a function in the page and returns what it returns.
    pub fn run(&self, script: &str) -> Value {
        self.post("/execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// Types into the first element that matches `selector`, as a user would.
    pub fn press(&self, selector: &str, keys: &str) {
        self.post(
            &format!("/element/{}/value", self.element(selector)),
            &json!({ "text": keys }),
        );
    }

    /// Clicks the first element that matches `selector`.
    pub fn click(&self, selector: &str) {
        self.post(
            &format!("/element/{}/click", self.element(selector)),
            &json!({}),
        );
    }

    /// Drags the mouse across an element: presses it at one share of its width and lets go at another.
    pub fn drag(&self, selector: &str, from: f64, to: f64) {
        let element = self.element(selector);
        let width = self
            .run(&format!(
                "return document.querySelector({}).clientWidth;",
                json!(selector)
            ))
            .as_f64()
            .expect("a width");
        // Offsets count from the middle of the element.
        let place = |share: f64| {
            let x = ((share - 0.5) * width).round();
            json!({ "type": "pointerMove", "duration": 50, "x": x, "y": 0, "origin": { "element-6066-11e4-a52e-4f735466cecf": element } })
        };
        let down = json!({ "type": "pointerDown", "button": 0 });
        let up = json!({ "type": "pointerUp", "button": 0 });
        let mouse = json!({ "type": "pointer", "id": "mouse", "actions": [place(from), down, place(to), up] });
        self.post("/actions", &json!({ "actions": [mouse] }));
    }

    /// What the page wrote to the console since the last call: errors, refused requests, violations of its policy.
    pub fn console(&self) -> Vec<String> {
        let log = self.post("/se/log", &json!({ "type": "browser" }));
        log.as_array()
            .expect("a list")
            .iter()
            .map(|entry| entry["message"].to_string())
            .collect()
    }

    /// Whether a dialogue such as an alert is open.
    pub fn has_dialogue(&self) -> bool {
        let path = format!("/session/{}/alert/text", self.session);
        request(self.port, "GET", &path, None).0 == 200
    }

    /// Addresses that pages have asked for since the last call, but for files and data; answered or not.
    pub fn asked(&self) -> Vec<String> {
        let log = self.post("/se/log", &json!({ "type": "performance" }));
        let messages = log.as_array().expect("a list").iter().map(|entry| {
            serde_json::from_str::<Value>(entry["message"].as_str().expect("a message"))
                .expect("JSON")
        });
        messages
            .filter(|message| message["message"]["method"] == "Network.requestWillBeSent")
            .map(|message| {
                message["message"]["params"]["request"]["url"]
                    .as_str()
                    .expect("an address")
                    .to_owned()
            })
            .filter(|url| !url.starts_with("file:") && !url.starts_with("data:"))
            .collect()
    }

    /// First lines of the requests that reached the proxy, the browser's own errands among them.
    pub fn requests(&self) -> Vec<String> {
        self.proxy
            .seen
            .lock()
            .expect("no panic while counting")
            .clone()
    }

    fn element(&self, selector: &str) -> String {
        let found = self.post(
            "/element",
            &json!({ "using": "css selector", "value": selector }),
        );
        let (_, id) = found
            .as_object()
            .and_then(|element| element.iter().next())
            .expect("an element");
        id.as_str().expect("an element").to_owned()
    }

    fn post(&self, path: &str, body: &Value) -> Value {
        self.call("POST", &format!("/session/{}{path}", self.session), body)
    }

    fn call(&self, method: &str, path: &str, body: &Value) -> Value {
        let (status, mut answer) = request(self.port, method, path, Some(body));
        assert_eq!(status, 200, "{method} {path}: {answer}");
        answer["value"].take()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() {
            request(
                self.port,
                "DELETE",
                &format!("/session/{}", self.session),
                None,
            );
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

/// One HTTP request to this machine; returns status and JSON body.
fn request(port: u16, method: &str, path: &str, body: Option<&Value>) -> (u16, Value) {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).expect("the driver listens");
    stream
        .set_read_timeout(Some(Duration::from_secs(120)))
        .expect("a timeout");
    let body = body.map(Value::to_string).unwrap_or_default();
    let head = format!(
        "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        body.len()
    );
    stream
        .write_all(head.as_bytes())
        .and_then(|()| stream.write_all(body.as_bytes()))
        .expect("the driver reads");
    let mut reader = BufReader::new(stream);
    let mut line = String::new();
    reader.read_line(&mut line).expect("a status line");
    let status = line
        .split(' ')
        .nth(1)
        .and_then(|code| code.parse().ok())
        .expect("a status");
    let mut length = 0;
    loop {
        line.clear();
        reader.read_line(&mut line).expect("a header");
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().expect("a length");
        }
        if line.trim().is_empty() {
            break;
        }
    }
    let mut answer = vec![0; length];
    reader.read_exact(&mut answer).expect("a body");
    (status, serde_json::from_slice(&answer).expect("JSON"))
}

/// Notes the first line of each request and answers none.
struct Proxy {
    port: u16,
    seen: Arc<Mutex<Vec<String>>>,
}

impl Proxy {
    fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let seen = Arc::new(Mutex::new(Vec::new()));
        let notes = Arc::clone(&seen);
        std::thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let mut line = String::new();
                let _ = stream.set_read_timeout(Some(Duration::from_secs(2)));
                let _ = BufReader::new(stream).read_line(&mut line);
                notes
                    .lock()
                    .expect("no panic while counting")
                    .push(line.trim().to_owned());
            }
        });
        Self { port, seen }
    }
}
