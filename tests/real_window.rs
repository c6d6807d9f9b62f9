//! The real window on a display of its own: opened, driven by mouse and keyboard, closed.
//!
//! Truth: the pixels of the screen. What the harness of the other window tests cannot see is here:
//! the window system, the surface that pictures are presented on, and the program's own end. Needs
//! Xvfb, which `./dev test` installs, and an adapter; says so where one is missing.
#![cfg(all(feature = "gui", target_os = "linux"))]

#[path = "support/left_out.rs"]
mod left_out;
#[path = "support/waiting.rs"]
mod waiting;

use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConfigureWindowAux, ConnectionExt as _, ImageFormat, InputFocus,
    KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

const SIZE: [u16; 2] = [1280, 800];

/// A display without a screen to look at; it ends with the test.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    fn start() -> Option<Self> {
        let size = format!("{}x{}x24", SIZE[0], SIZE[1]);
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0", &size])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        let mut number = String::new();
        BufReader::new(server.stdout.take()?).read_line(&mut number).ok()?;
        Some(Self { server, name: format!(":{}", number.trim()) })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A person before the screen.
struct Person {
    x: RustConnection,
    root: u32,
}

impl Person {
    fn at(display: &Display) -> Self {
        let (x, screen) = x11rb::connect(Some(&display.name)).expect("the display answers");
        let root = x.setup().roots[screen].root;
        Self { x, root }
    }

    fn event(&self, kind: u8, detail: u8, [x, y]: [i16; 2]) {
        self.x.xtest_fake_input(kind, detail, 0, self.root, x, y, 0).expect("the display takes input");
        self.x.flush().expect("the display listens");
        // As slow as a quick hand: a window drawn by software sees each step.
        std::thread::sleep(Duration::from_millis(120));
    }

    fn move_to(&self, at: [i16; 2]) {
        self.event(MOTION_NOTIFY_EVENT, 0, at);
    }

    fn click(&self, at: [i16; 2]) {
        self.move_to(at);
        self.event(BUTTON_PRESS_EVENT, 1, at);
        self.event(BUTTON_RELEASE_EVENT, 1, at);
    }

    fn drag(&self, from: [i16; 2], to: [i16; 2]) {
        self.move_to(from);
        self.event(BUTTON_PRESS_EVENT, 1, from);
        self.move_to([(from[0] + to[0]) / 2, (from[1] + to[1]) / 2]);
        self.move_to(to);
        self.event(BUTTON_RELEASE_EVENT, 1, to);
    }

    /// Gives the keyboard to the window, as a window manager would.
    fn focus(&self) {
        let windows = self.x.query_tree(self.root).expect("a request").reply().expect("windows").children;
        let window = *windows.last().expect("a window is open");
        self.x.set_input_focus(InputFocus::PARENT, window, 0_u32).expect("a request");
        self.x.flush().expect("the display listens");
    }

    /// Holds the key of a Latin letter down for a while.
    fn hold(&self, letter: char, time: Duration) {
        let setup = self.x.setup();
        let (first, last) = (setup.min_keycode, setup.max_keycode);
        let map = self.x.get_keyboard_mapping(first, last - first + 1).expect("a request").reply().expect("keys");
        let per_key = usize::from(map.keysyms_per_keycode);
        let place = map.keysyms.chunks(per_key).position(|syms| syms.contains(&u32::from(letter)));
        let key = first + place.expect("the keyboard has the letter") as u8;
        self.event(KEY_PRESS_EVENT, key, [0, 0]);
        std::thread::sleep(time);
        self.event(KEY_RELEASE_EVENT, key, [0, 0]);
    }

    /// Resizes the window, as a window manager may to any size.
    fn resize(&self, [width, height]: [u16; 2]) {
        let windows = self.x.query_tree(self.root).expect("a request").reply().expect("windows").children;
        let window = *windows.last().expect("a window is open");
        let size = ConfigureWindowAux::new().width(u32::from(width)).height(u32::from(height));
        self.x.configure_window(window, &size).expect("a request");
        self.x.flush().expect("the display listens");
        std::thread::sleep(Duration::from_millis(500));
    }

    /// The pixels of the screen right of the panels, as blue, green, red and nothing.
    fn view(&self) -> Vec<u8> {
        let (left, top, width, height) = (400, 60, SIZE[0] - 420, SIZE[1] - 160);
        let image = self.x.get_image(ImageFormat::Z_PIXMAP, self.root, left, top, width, height, u32::MAX);
        image.expect("a request").reply().expect("an image").data
    }

    /// Waits until the view is as asked.
    fn until(&self, what: &str, holds: impl Fn(&[u8]) -> bool) -> Vec<u8> {
        waiting::wait_for(what, || {
            let view = self.view();
            if holds(&view) {
                return Some(view);
            }
            // Pictures of the screen take the time that the window needs to draw them.
            std::thread::sleep(Duration::from_millis(100));
            None
        })
    }
}

/// Share of pixels that differ clearly.
fn difference(one: &[u8], other: &[u8]) -> f64 {
    let differ = |(one, other): (&[u8], &[u8])| one.iter().zip(other).any(|(one, other)| one.abs_diff(*other) > 24);
    let pixels = one.chunks(4).zip(other.chunks(4));
    pixels.filter(|pair| differ(*pair)).count() as f64 / (one.len() / 4) as f64
}

/// Share of pixels that are brighter than the window's own dark ground.
fn lit(view: &[u8]) -> f64 {
    view.chunks(4).filter(|pixel| pixel[..3].iter().any(|value| *value > 110)).count() as f64 / (view.len() / 4) as f64
}

/// Starts the program on a display, with a home of its own.
fn open(display: &Display, home: &Path, arguments: &[&OsStr]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_selflink"))
        .args(arguments)
        .env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY")
        .env("XDG_RUNTIME_DIR", home)
        .env("XDG_DATA_HOME", home)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program was built")
}

/// Ends the program; what it wrote to its standard error.
fn end(mut window: Child) -> String {
    let mut errors = window.stderr.take().expect("piped");
    window.kill().expect("it can be ended");
    window.wait().expect("it has ended");
    let mut said = String::new();
    errors.read_to_string(&mut said).expect("text");
    said
}

#[test]
fn a_window_is_opened_driven_and_closed() {
    let Some(display) = Display::start() else {
        left_out::left_out("the real window; Xvfb is not installed");
        return;
    };
    let home = tempfile::tempdir().expect("a folder for what the window keeps");
    let mut window = open(&display, home.path(), &["cornell", "--epsilon", "1e-2"].map(OsStr::new));
    let person = Person::at(&display);

    let first = person.until("a lit picture", |view| lit(view) > 0.2);
    // Orbit, with the mouse.
    person.drag([800, 400], [700, 420]);
    let turned = person.until("the view turning", |view| difference(&first, view) > 0.1);
    // Fly forward, with a key.
    person.focus();
    person.hold('w', Duration::from_millis(400));
    let flown = person.until("the view flying", |view| difference(&turned, view) > 0.05);
    // Select: a tag comes beside the surface at the pointer.
    person.click([800, 400]);
    person.until("the tag", |view| difference(&flown, view) > 0.002);

    // As small as a window can be, and back.
    person.resize([1, 1]);
    person.until("the window being small", |view| lit(view) < 0.01);
    person.resize(SIZE);
    person.until("the picture being back", |view| lit(view) > 0.2);

    assert!(window.try_wait().expect("its state").is_none(), "it is still open");
    // A window manager's close would need one; the display's end is what a window gets when a
    // session ends.
    let said = end(window);
    assert!(!said.contains("panicked"), "{said}");
}

/// Truth: the fonts that come with the program have no kanji, and the log of what looks for others
/// in the system tells that it did. The window waits for that before it draws such a name.
#[test]
fn letters_that_our_fonts_lack_are_looked_for_in_the_system() {
    let Some(display) = Display::start() else {
        left_out::left_out("the real window; Xvfb is not installed");
        return;
    };
    let home = tempfile::tempdir().expect("a folder for the scene and what the window keeps");
    let scene = home.path().join("部屋.obj");
    let room = "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 0 0 4\nv 4 0 4\nv 4 3 4\nv 0 3 4\n\
        f 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 2 6 7 3\nf 5 6 2 1\nf 4 3 7 8\n";
    std::fs::write(&scene, room).expect("a writable folder");
    let options = ["--ceiling-light", "--epsilon", "1e-2", "--log", "egui_system_font_provider=debug"];
    let arguments: Vec<&OsStr> = std::iter::once(scene.as_os_str()).chain(options.map(OsStr::new)).collect();
    let window = open(&display, home.path(), &arguments);
    Person::at(&display).until("a lit picture", |view| lit(view) > 0.2);
    let said = end(window);
    assert!(said.contains("Enumerated system fonts"), "{said}");
}
