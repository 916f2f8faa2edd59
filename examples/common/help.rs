//! What the mouse and the keys do.

/// Every key and button with what it does.
pub const CONTROLS: [(&str, &str); 12] = [
    ("left mouse button", "drag the cloth"),
    ("wheel while dragging", "nearer, farther"),
    ("P while dragging", "pin what is held"),
    ("P", "release these pins"),
    ("arrows, PgUp, PgDn", "move the ball"),
    ("left Shift", "… faster"),
    ("right mouse button", "turn the camera"),
    ("middle mouse button", "move the camera"),
    ("wheel", "zoom"),
    ("1 to 8", "scenes"),
    ("R", "reset"),
    ("Space, N", "pause, single step"),
];

/// As text, one line each, indented.
pub fn text() -> String {
    CONTROLS
        .iter()
        .map(|(control, action)| format!("  {control:<22}{action}\n"))
        .collect()
}
