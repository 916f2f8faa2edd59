//! Controls by mouse, keys, fingers and gamepad.

/// Every key and button with what it does.
pub const CONTROLS: [(&str, &str); 26] = [
    ("left mouse button", "drag the cloth"),
    ("wheel while dragging", "nearer, farther"),
    ("P while dragging", "pin what is held"),
    ("P", "release these pins"),
    ("I J K L", "move a hand over the picture"),
    ("G", "… take the cloth there, let go"),
    ("U, O", "… nearer, farther"),
    ("arrows, PgUp, PgDn", "move the ball"),
    ("left Shift", "… faster"),
    ("right mouse button", "turn the camera"),
    ("middle mouse button", "move the camera"),
    ("wheel", "zoom"),
    ("W A S D, + and −", "turn the camera, zoom"),
    ("1 to 9, [ and ]", "scenes, previous and next"),
    ("R", "reset"),
    ("Space, N", "pause, single step"),
    ("C", "the other solver beside"),
    ("H", "hide or show the panel"),
    ("B", "blur what is not in focus"),
    ("F5, F9", "save, load the settings"),
    ("F12", "save a picture"),
    ("Tab, Shift Tab", "through the panel"),
    ("Space, arrows, Esc", "… press, change, leave"),
    ("one finger, two", "drag; turn and zoom"),
    ("sticks, triggers", "ball and camera, zoom"),
    ("south, west, shoulders", "pause, reset, scenes"),
];

/// The controls as text, one line each, indented.
pub fn text() -> String {
    CONTROLS
        .iter()
        .map(|(control, action)| format!("  {control:<24}{action}\n"))
        .collect()
}
