//! A browser without a window, told what to do over its debugging protocol.
//!
//! Chromium speaks it through two pipes (`--remote-debugging-pipe`): JSON, each message ended by a zero byte. A shell puts its standard
//! input and output where the browser looks for the pipes, so that nothing but the browser itself is needed.

use crate::cmd::Failure;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Programs that speak the protocol, by the names that systems give them.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
/// How long an answer may take. A page of a large part is drawn in software where there is no graphics card, and the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(240);

/// A browser with one page open at a time.
pub struct Chrome {
    child: Child,
    input: ChildStdin,
    answers: Receiver<Value>,
    profile: PathBuf,
    next: u64,
    session: Option<String>,
    /// What the page complained of since it was opened.
    pub complaints: Vec<String>,
}

/// The browser of this machine, or the one that `CHROMIUM` names.
fn found() -> Result<PathBuf, Failure> {
    let missing = Failure::NoPeer {
        what: "a browser",
        how: "apt-get install chromium (Debian), or put the path of a Chromium or Chrome into the variable CHROMIUM",
    };
    if let Some(named) = std::env::var_os("CHROMIUM").map(PathBuf::from) {
        return if named.is_file() { Ok(named) } else { Err(missing) };
    }
    let folders: Vec<PathBuf> =
        std::env::var_os("PATH").map(|p| std::env::split_paths(&p).collect()).unwrap_or_default();
    let all = NAMES.iter().flat_map(|name| folders.iter().map(move |f| f.join(name)));
    all.into_iter().find(|p| p.is_file()).ok_or(missing)
}

/// An answer that is not what it must be.
pub fn odd(what: &str, why: impl std::fmt::Display) -> Failure {
    Failure::Answer { line: format!("the browser, {what}"), why: why.to_string() }
}

impl Chrome {
    /// Starts the browser.
    ///
    /// # Errors
    /// Where there is none, or it cannot be started.
    pub fn start() -> Result<Self, Failure> {
        let program = found()?;
        let profile = std::env::temp_dir().join(format!("osculate-browser-{}", std::process::id()));
        let mut command = Command::new("sh");
        command.args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1"]).arg(&program);
        command.args([
            "--headless=new",
            "--remote-debugging-pipe",
            "--no-sandbox",
            "--no-first-run",
            "--disable-dev-shm-usage",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--force-device-scale-factor=1",
            "--font-render-hinting=none",
            "--allow-file-access-from-files",
        ]);
        command.arg(format!("--user-data-dir={}", profile.display())).arg("about:blank");
        let line = program.display().to_string();
        let start = |why| Failure::Start { line: line.clone(), why };
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(start)?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(odd("at its start", "it has no pipes"));
        };
        let (send, answers) = channel();
        std::thread::spawn(move || {
            let mut output = BufReader::new(output);
            let mut message = Vec::new();
            while output.read_until(0, &mut message).is_ok_and(|n| n > 0) {
                message.pop();
                let told = serde_json::from_slice(&message).is_ok_and(|v: Value| send.send(v).is_ok());
                message.clear();
                if !told {
                    break;
                }
            }
        });
        Ok(Self { child, input, answers, profile, next: 0, session: None, complaints: Vec::new() })
    }

    /// Asks for something and waits for the answer; what the page complains of meanwhile is kept.
    ///
    /// # Errors
    /// Where the browser refuses, or does not answer.
    pub fn ask(&mut self, method: &str, params: Value) -> Result<Value, Failure> {
        self.next += 1;
        let id = self.next;
        let mut message = json!({"id": id, "method": method, "params": params});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.input.write_all(&bytes).map_err(|why| odd(method, why))?;
        let until = Instant::now() + PATIENCE;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let answer = self.answers.recv_timeout(left).map_err(|why| match why {
                RecvTimeoutError::Timeout => odd(method, format!("no answer in {} s", PATIENCE.as_secs())),
                RecvTimeoutError::Disconnected => odd(method, "it has ended"),
            })?;
            if answer["id"] != json!(id) {
                self.complaints.extend(complaint(&answer));
                continue;
            }
            return match answer.get("error") {
                Some(why) => Err(odd(method, why)),
                None => Ok(answer["result"].clone()),
            };
        }
    }

    /// Opens a page in place of the one before, and listens to what it complains of.
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub fn open(&mut self, address: &str) -> Result<(), Failure> {
        self.session = None;
        let made = self.ask("Target.createTarget", json!({"url": "about:blank"}))?;
        let target = json!({"targetId": made["targetId"], "flatten": true});
        let attached = self.ask("Target.attachToTarget", target)?;
        self.session = attached["sessionId"].as_str().map(str::to_owned);
        for method in ["Page.enable", "Runtime.enable", "Log.enable"] {
            self.ask(method, json!({}))?;
        }
        self.complaints.clear();
        self.ask("Page.navigate", json!({"url": address}))?;
        Ok(())
    }

    /// The value of an expression on the page; promises are waited for.
    ///
    /// # Errors
    /// As [`ask`](Self::ask), and where it throws.
    pub fn value(&mut self, expression: &str) -> Result<Value, Failure> {
        let params = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.ask("Runtime.evaluate", params)?;
        match answer.get("exceptionDetails") {
            Some(thrown) => Err(odd(expression, thrown)),
            None => Ok(answer["result"]["value"].clone()),
        }
    }

    /// Waits until an expression is true.
    ///
    /// # Errors
    /// Where it does not become true in time.
    pub fn wait(&mut self, expression: &str) -> Result<(), Failure> {
        let until = Instant::now() + PATIENCE;
        // While a page is being changed for another one an expression may throw: that is not yet true.
        while self.value(&format!("Boolean({expression})")).ok() != Some(json!(true)) {
            if Instant::now() > until {
                let (said, last) =
                    (self.complaints.join("; "), self.value("document.body.innerText.slice(0, 200)"));
                return Err(odd(
                    expression,
                    format!("it does not become true; the page says: {said}; {last:?}"),
                ));
            }
            std::thread::sleep(Duration::from_millis(30));
        }
        Ok(())
    }
}

impl Drop for Chrome {
    fn drop(&mut self) {
        self.session = None;
        // It ends with its pipes in any case; asked for, it takes its children with it.
        let _ = self.ask("Browser.close", json!({}));
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.profile);
    }
}

/// What an event complains of: an exception, or an error or a warning on the console.
fn complaint(event: &Value) -> Option<String> {
    let params = &event["params"];
    match event["method"].as_str()? {
        "Runtime.exceptionThrown" => Some(params["exceptionDetails"].to_string()),
        "Runtime.consoleAPICalled" if ["error", "warning", "assert"].contains(&params["type"].as_str()?) => {
            Some(params["args"].to_string())
        }
        // The renderer without a graphics card says of itself that it is slow.
        "Log.entryAdded" if ["error", "warning"].contains(&params["entry"]["level"].as_str()?) => {
            let text = params["entry"]["text"].as_str().unwrap_or_default();
            (!text.contains("GPU stall") && !text.contains("SwiftShader")).then(|| text.to_owned())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_and_warnings_are_complaints_and_words_are_not() {
        let said = |kind: &str| json!({"method": "Runtime.consoleAPICalled", "params": {"type": kind, "args": ["x"]}});
        assert_eq!(complaint(&said("error")), Some("[\"x\"]".to_owned()));
        assert_eq!(complaint(&said("log")), None);
        let thrown =
            json!({"method": "Runtime.exceptionThrown", "params": {"exceptionDetails": {"text": "y"}}});
        assert!(complaint(&thrown).is_some_and(|c| c.contains('y')));
        let entry = |text: &str| json!({"method": "Log.entryAdded", "params": {"entry": {"level": "warning", "text": text}}});
        assert_eq!(complaint(&entry("broken")), Some("broken".to_owned()));
        assert_eq!(complaint(&entry("GPU stall due to ReadPixels")), None);
        assert_eq!(complaint(&json!({"id": 3, "result": {}})), None);
    }
}
