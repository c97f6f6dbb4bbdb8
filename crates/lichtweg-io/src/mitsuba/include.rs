//! Files: the scene itself, `<include>`, and the folders in which files are looked for.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lichtweg::scene::description::{Diagnostic, Span};
use roxmltree::{Document, Error as XmlError, ParsingOptions};

use super::element::Element;
use super::legacy::is_legacy;
use super::tree::{Class, ObjectId};
use super::walk::{MOST_FILES, Walk};
use crate::mesh::read_regular_file;

/// Nodes of one XML file.
const MOST_NODES: u32 = 50_000_000;

impl Walk<'_> {
    /// Reads a file into `parent`; `from` is where it is asked for, and `None` for the scene itself.
    pub fn read_file(&mut self, path: &Path, from: Option<Span>, parent: ObjectId, depth: usize) {
        let missing = |message: String| match from {
            Some(span) => Diagnostic::error("missing-file", message).at(span, ""),
            None => Diagnostic::error("missing-file", message),
        };
        let text = read_regular_file(path)
            .map_err(|(found, help)| missing(format!("cannot read {}: {found}", path.display())).help(help))
            .and_then(|bytes| {
                String::from_utf8(bytes).map_err(|_| missing(format!("{} is no UTF-8 text", path.display())))
            });
        match text {
            Ok(text) => {
                let real = path.canonicalize().unwrap_or_else(|_| path.to_owned());
                self.open_files.push(real);
                self.read_text(path, text, parent, depth);
                self.open_files.pop();
            }
            Err(diagnostic) => {
                self.broken = true;
                self.diagnostics.push(diagnostic);
            }
        }
    }

    /// Reads the text of a file into `parent`.
    pub fn read_text(&mut self, path: &Path, text: String, parent: ObjectId, depth: usize) {
        self.files_read += 1;
        let outer = (self.file, self.legacy, Arc::clone(&self.search));
        self.file = self.sources.add(path, text.clone());
        Arc::make_mut(&mut self.search).insert(0, path.parent().unwrap_or(Path::new("")).to_owned());
        let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
        match Document::parse_with_options(&text, options) {
            Ok(document) => self.document(&document, parent, depth),
            Err(error) => self.syntax_error(&error, &text),
        }
        (self.file, self.legacy, self.search) = outer;
    }

    fn document(&mut self, document: &Document<'_>, parent: ObjectId, depth: usize) {
        let node = document.root_element();
        let root = self.open(node);
        self.legacy = match root.get("version").map(|(v, span)| (is_legacy(v), v.to_owned(), span)) {
            Some((Some(legacy), ..)) => legacy,
            Some((None, version, span)) => {
                self.error("bad-value", format!("version number expected, got '{version}'"), span);
                false
            }
            None => {
                let message = format!("<{}> needs the attribute \"version\"", root.tag);
                let diagnostic = Diagnostic::error("missing-attribute", message).at(root.span, "");
                self.diagnostics.unsupported(diagnostic, "version 3.0.0 is assumed");
                false
            }
        };
        match Class::of_tag(&root.tag) {
            Some(Class::Scene) => {
                self.check(&root, &[], &["version", "id", "name", "type"]);
                self.children(node, parent, depth);
            }
            Some(class) if depth > 0 => {
                if self.check(&root, &["type"], &["version", "id", "name"]) {
                    self.nested_object(node, &root, class, parent, depth);
                }
            }
            _ => {
                self.broken = true;
                self.error("not-a-scene", format!("<scene> expected, got <{}>", root.tag), root.span);
            }
        }
    }

    /// `<include filename="..."/>`.
    pub fn include(&mut self, element: &Element, parent: ObjectId, depth: usize) {
        if !self.check(element, &["filename"], &["name"]) {
            return;
        }
        let (name, span) = element.get("filename").unwrap_or(("", element.span));
        let Some(path) = find(&self.search, name) else {
            self.broken = true;
            self.diagnostics.push(not_found(name, span, &self.search));
            return;
        };
        let real = path.canonicalize().unwrap_or_else(|_| path.clone());
        if self.open_files.contains(&real) {
            return self.error("include-cycle", format!("{} includes itself", path.display()), span);
        }
        if self.files_read >= MOST_FILES {
            let message = format!("the scene includes more than {MOST_FILES} files");
            return self.error("too-many-files", message, span);
        }
        self.read_file(&path, Some(span), parent, depth);
    }

    /// `<path value="..."/>`: one more folder to look in, before the others.
    pub fn path(&mut self, element: &Element, parent: ObjectId) {
        if !self.check(element, &["value"], &[]) {
            return;
        }
        let (name, span) = element.get("value").unwrap_or(("", element.span));
        if parent != ObjectId::SCENE {
            return self.error("misplaced-element", "<path> belongs directly into <scene>", element.span);
        }
        match find(&self.search, name).filter(|p| p.is_dir()) {
            Some(path) => Arc::make_mut(&mut self.search).insert(0, path),
            None => self.error("missing-file", format!("there is no folder \"{name}\""), span),
        }
    }

    fn syntax_error(&mut self, error: &XmlError, text: &str) {
        self.broken = true;
        let position = error.pos();
        let line_start = match position.row.saturating_sub(1) as usize {
            0 => 0,
            row => text.match_indices('\n').nth(row - 1).map_or(text.len(), |(at, _)| at + 1),
        };
        let column = text[line_start..].char_indices().nth(position.col.saturating_sub(1) as usize);
        let at = line_start + column.map_or(text.len() - line_start, |(at, _)| at);
        // The position at the end of the message is that of the caret.
        let message = error.to_string().replace('\n', "\\n");
        let message =
            message.rsplit_once(" at ").filter(|(_, p)| p.contains(':')).map_or(&*message, |(m, _)| m);
        let diagnostic = Diagnostic::error("xml-syntax", format!("no well-formed XML: {message}"));
        // A caret below the end of a line stays on that line.
        let width = text[at..].chars().next().filter(|c| *c != '\n').map_or(0, char::len_utf8);
        self.diagnostics.push(diagnostic.at(self.span(at, at + width), ""));
    }
}

/// The file of this name in the first of the folders that has it.
pub(super) fn find(search: &[PathBuf], name: &str) -> Option<PathBuf> {
    let in_folders = |name: &str| search.iter().map(|folder| folder.join(name)).find(|p| p.exists());
    // Scenes written on Windows separate folders by backslashes.
    in_folders(name).or_else(|| in_folders(&name.replace('\\', "/"))).filter(|_| !name.is_empty())
}

/// "There is no such file", with the folders that were tried.
pub(super) fn not_found(name: &str, span: Span, search: &[PathBuf]) -> Diagnostic {
    let folder =
        |p: &PathBuf| if p.as_os_str().is_empty() { ".".to_owned() } else { p.display().to_string() };
    let folders: Vec<String> = search.iter().map(folder).collect();
    Diagnostic::error("missing-file", format!("there is no file \"{name}\""))
        .at(span, "")
        .help(format!("looked in {}", folders.join(", ")))
}
