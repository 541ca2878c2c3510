//! A report in the browser: opened, looked at, clicked.

use super::chrome::{Chrome, odd};
use crate::cmd::Failure;
use serde_json::{Value, json};
use std::path::Path;

/// How large the window is, in pixels.
#[derive(Clone, Copy)]
pub struct Window {
    pub width: u32,
    pub height: u32,
    pub phone: bool,
}

/// A desk's screen.
pub const DESK: Window = Window { width: 1440, height: 1000, phone: false };
/// A phone's.
pub const PHONE: Window = Window { width: 390, height: 844, phone: true };

/// Columns and rows of the fields whose mean colours stand for a picture.
pub const FIELDS: [usize; 2] = [18, 12];

/// What the sum of [`Chrome::slowness`] takes on an idle core, ms.
const IDLE_MS: f64 = 250.0;

/// What a picture looks like.
pub struct Look {
    /// The picture, PNG.
    pub png: Vec<u8>,
    /// Mean colours of its fields, row by row, 0 to 255.
    pub fields: Vec<[u8; 3]>,
    /// How many colours there are, counted in steps of 8.
    pub colours: u64,
}

impl Look {
    /// Mean difference of the fields' colours from others, 0 to 255.
    pub fn differs_by(&self, fields: &[[u8; 3]]) -> f64 {
        if fields.len() != self.fields.len() {
            return 255.0;
        }
        let pairs = self.fields.iter().flatten().zip(fields.iter().flatten());
        pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / (3 * fields.len()).max(1) as f64
    }
}

impl Chrome {
    /// Draws something once: the first page that draws waits for the browser's renderer, seconds where it is software, and no report is to blame.
    pub fn warm(&mut self) -> Result<(), Failure> {
        self.open("about:blank")?;
        let drawn = "(() => { const gl = document.createElement('canvas').getContext('webgl2'); gl?.clear(gl.COLOR_BUFFER_BIT); \
                     gl?.finish(); return gl ? 1 : 0; })()";
        if self.number(drawn)? > 0.0 { Ok(()) } else { Err(odd("WebGL", "it has none")) }
    }

    /// Opens a report and waits until its part is drawn.
    pub fn report(&mut self, file: &Path) -> Result<(), Failure> {
        self.open(&format!("file://{}", file.display()))?;
        let drawn = "performance.getEntriesByName('osculate-drawn').length > 0";
        let still = "document.getElementById('still-words')?.textContent";
        self.wait(&format!("{drawn} || /cannot/.test({still})"))?;
        let given_up = self.value(&format!("{drawn} ? null : {still}"))?;
        given_up.as_str().map_or(Ok(()), |words| Err(odd("the view", words)))
    }

    /// Sets the window, the colours that the reader likes, and whether the page is printed.
    pub fn window(&mut self, window: Window, dark: bool, print: bool) -> Result<(), Failure> {
        let Window { width, height, phone } = window;
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": phone});
        self.ask("Emulation.setDeviceMetricsOverride", size)?;
        let scheme = if dark { "dark" } else { "light" };
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        let media = if print { "print" } else { "screen" };
        self.ask("Emulation.setEmulatedMedia", json!({"media": media, "features": features}))?;
        self.settle()
    }

    /// Two frames pass, so that what was asked for is drawn.
    pub fn settle(&mut self) -> Result<(), Failure> {
        let frames = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 60))))";
        self.value(frames).map(|_| ())
    }

    /// The box of an element in the window after it was brought into it: left, top, width, height.
    pub fn place(&mut self, selector: &str) -> Result<[f64; 4], Failure> {
        let expression = format!(
            "(() => {{ const e = document.querySelector({selector:?}); if (!e) return null; \
             e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); const r = e.getBoundingClientRect(); \
             return [r.left, r.top, r.width, r.height]; }})()"
        );
        let found = self.value(&expression)?;
        serde_json::from_value(found).map_err(|_| odd(selector, "there is no such element"))
    }

    /// A press of the mouse in the middle of an element.
    pub fn click(&mut self, selector: &str) -> Result<(), Failure> {
        let [left, top, width, height] = self.place(selector)?;
        let (x, y) = (left + 0.5 * width, top + 0.5 * height);
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            let press = json!({"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1});
            self.ask("Input.dispatchMouseEvent", press)?;
        }
        self.settle()
    }

    /// A key of the keyboard, pressed so many times.
    pub fn key(&mut self, name: &str, code: u32, times: usize) -> Result<(), Failure> {
        for _ in 0..times {
            for kind in ["keyDown", "keyUp"] {
                let press = json!({"type": kind, "key": name, "code": name, "windowsVirtualKeyCode": code});
                self.ask("Input.dispatchKeyEvent", press)?;
            }
        }
        self.settle()
    }

    /// The window as it is, or the box of an element in it.
    pub fn look(&mut self, selector: Option<&str>) -> Result<Look, Failure> {
        let mut params = json!({"format": "png"});
        if let Some(selector) = selector {
            let [x, y, width, height] = self.place(selector)?;
            self.settle()?;
            let scrolled = self.value("[window.scrollX, window.scrollY]")?;
            let shift = |k: usize| scrolled[k].as_f64().unwrap_or(0.0);
            let clip =
                json!({"x": x + shift(0), "y": y + shift(1), "width": width, "height": height, "scale": 1});
            params["clip"] = clip;
        }
        let shot = self.ask("Page.captureScreenshot", params)?;
        let text = shot["data"].as_str().unwrap_or_default().to_owned();
        let png = bytes_of_base64(&text).ok_or_else(|| odd("its picture", "it is no base64"))?;
        let [columns, rows] = FIELDS;
        // The browser reads its own picture: a page of its own, as the report lets nothing be loaded.
        let expression = format!(
            "(async () => {{ const bytes = Uint8Array.from(atob('{text}'), (c) => c.charCodeAt(0)); \
             const picture = await createImageBitmap(new Blob([bytes], {{ type: 'image/png' }})); \
             const [w, h] = [picture.width, picture.height]; const sheet = new OffscreenCanvas(w, h); \
             const pen = sheet.getContext('2d'); pen.drawImage(picture, 0, 0); \
             const all = pen.getImageData(0, 0, w, h).data; const kinds = new Set(); \
             const sums = new Float64Array({columns} * {rows} * 4); \
             for (let y = 0; y < h; y++) for (let x = 0; x < w; x++) {{ const p = 4 * (y * w + x); \
             const f = 4 * (Math.floor(y * {rows} / h) * {columns} + Math.floor(x * {columns} / w)); \
             for (let k = 0; k < 3; k++) sums[f + k] += all[p + k]; sums[f + 3]++; \
             kinds.add((all[p] >> 3 << 10) | (all[p + 1] >> 3 << 5) | (all[p + 2] >> 3)); }} \
             const fields = []; for (let f = 0; f < sums.length; f += 4) \
             fields.push([0, 1, 2].map((k) => Math.round(sums[f + k] / Math.max(sums[f + 3], 1)))); \
             return {{ fields, colours: kinds.size }}; }})()"
        );
        let found = self.value(&expression)?;
        let fields =
            serde_json::from_value(found["fields"].clone()).map_err(|why| odd("its picture", why))?;
        Ok(Look { png, fields, colours: found["colours"].as_u64().unwrap_or(0) })
    }

    /// The page as it is printed, PDF.
    pub fn printed(&mut self) -> Result<Vec<u8>, Failure> {
        let answer = self.ask("Page.printToPDF", json!({"printBackground": true}))?;
        let data = answer["data"].as_str().and_then(bytes_of_base64);
        data.ok_or_else(|| odd("its print", "it is no base64"))
    }

    /// How many times as long as on an idle core of today a fixed sum takes here now; at least 1.
    pub fn slowness(&mut self) -> Result<f64, Failure> {
        let sum = "(() => { const t = performance.now(); let x = 0; for (let i = 0; i < 2e8; i++) x += i % 7; \
                   return x > 0 ? performance.now() - t : 0; })()";
        Ok((self.number(sum)? / IDLE_MS).max(1.0))
    }

    /// A number on the page.
    pub fn number(&mut self, expression: &str) -> Result<f64, Failure> {
        let value: Value = self.value(expression)?;
        value.as_f64().ok_or_else(|| odd(expression, format!("{value} is no number")))
    }
}

/// The bytes of standard base64 (RFC 4648, section 4); `None` where it is none.
fn bytes_of_base64(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    for four in text.as_bytes().chunks(4) {
        let mut word = 0_u32;
        let mut kept = 0;
        for k in 0..4 {
            let value = match four.get(k).copied()? {
                c @ b'A'..=b'Z' => c - b'A',
                c @ b'a'..=b'z' => c - b'a' + 26,
                c @ b'0'..=b'9' => c - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                b'=' if k > 1 => 0,
                _ => return None,
            };
            word = (word << 6) | u32::from(value);
            kept += usize::from(four[k] != b'=');
        }
        out.extend(word.to_be_bytes()[1..].iter().take(kept - 1));
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_agrees_with_the_vectors_of_rfc_4648() {
        for (plain, coded) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(bytes_of_base64(coded).as_deref(), Some(plain.as_bytes()));
        }
        assert_eq!(bytes_of_base64("Zm9"), None);
        assert_eq!(bytes_of_base64("Z*9v"), None);
    }

    #[test]
    fn looks_differ_by_their_mean_colours() {
        let look = Look { png: Vec::new(), fields: vec![[0, 0, 0], [30, 0, 0]], colours: 2 };
        assert_eq!(look.differs_by(&[[0, 0, 0], [0, 0, 0]]), 5.0);
        assert_eq!(look.differs_by(&[[0, 0, 0]]), 255.0);
    }
}
