//! Messages between the page and the program, as JSON.

use crate::pictures::Pictures;
use serde::{Deserialize, Serialize};

/// A message of the page.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// The size of the screen in cells; the whole screen is sent again.
    Resize {
        /// Columns.
        columns: u16,
        /// Rows.
        rows: u16,
    },
    /// Whether the page has a light background.
    Background {
        /// Light.
        light: bool,
    },
    /// A key, named as in the key table.
    Key(String),
    /// Pasted text.
    Paste(String),
    /// A mouse action in a cell.
    Mouse {
        /// What was done.
        kind: MouseKind,
        /// Column, from 0.
        column: u16,
        /// Row, from 0.
        row: u16,
    },
    /// A file to store: dropped on the page, or kept by the browser.
    File {
        /// Path.
        path: String,
        /// Content.
        content: Content,
        /// When it was last changed, in milliseconds since 1970.
        modified: f64,
    },
    /// The settings of a link, in order: `lesson`, `scene` or `journal`, and paths of the scene with values.
    Open(Vec<(String, String)>),
    /// Run the session's scene with the settings of the sliders, and return pictures.
    Pictures {
        /// Paths and values.
        settings: Vec<(String, String)>,
        /// Part of the load path, up to 1.
        part: f64,
    },
    /// Solve a scene and return its trace.
    Trace(String),
    /// Only continue.
    Advance,
}

/// A mouse action.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MouseKind {
    /// A click.
    Click,
    /// The wheel was turned up.
    Up,
    /// The wheel was turned down.
    Down,
}

/// Content of a file.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Content {
    /// Text.
    Text(String),
    /// Bytes that are not text.
    Bytes(Vec<u8>),
}

impl From<Vec<u8>> for Content {
    fn from(bytes: Vec<u8>) -> Content {
        String::from_utf8(bytes).map_or_else(|e| Content::Bytes(e.into_bytes()), Content::Text)
    }
}

impl From<Content> for Vec<u8> {
    fn from(content: Content) -> Vec<u8> {
        match content {
            Content::Text(text) => text.into_bytes(),
            Content::Bytes(bytes) => bytes,
        }
    }
}

/// What changed since the last update.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Update {
    /// Number and HTML of each row of the screen that changed.
    pub rows: Vec<(usize, String)>,
    /// Files that were written, or removed (`None`).
    pub files: Vec<(String, Option<Content>)>,
    /// Text for the clipboard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub copy: Option<String>,
    /// The requested pictures, or why there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pictures: Option<Result<Pictures, String>>,
    /// The requested trace, or why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trace: Option<Result<String, String>>,
    /// Whether the program has work left, so that it must be continued at once.
    pub busy: bool,
}
