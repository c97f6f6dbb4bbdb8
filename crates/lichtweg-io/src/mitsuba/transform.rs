//! `<transform>`: a chain of elementary maps, each applied after those above it.

use lichtweg::scene::description::{Diagnostic, Span};
use lichtweg_ray::math::{Affine, Motion};
use roxmltree::Node;

use super::element::Element;
use super::number::{parse_float, parse_floats};
use super::suggest::hint;
use super::tree::{ObjectId, Value};
use super::walk::Walk;

impl Walk<'_> {
    /// Reads a `<transform>` as a parameter of `parent`.
    pub fn transform(&mut self, node: Node<'_, '_>, element: &Element, parent: ObjectId) {
        if !self.check(element, &["name"], &[]) {
            return;
        }
        let value = self.chain(node, element).map_or(Value::Invalid, Value::Transform);
        self.add(parent, element, value, element.span);
    }

    /// Reads an `<animation>`, transforms at times, as a parameter of `parent` (Mitsuba 0.6, `src/libcore/track.cpp`).
    pub fn animation(&mut self, node: Node<'_, '_>, element: &Element, parent: ObjectId) {
        if !self.check(element, &["name"], &[]) {
            return;
        }
        let errors = self.diagnostics.list.len();
        let mut keys = Vec::new();
        for child in node.children() {
            if !child.is_element() {
                self.refuse_text(child);
                continue;
            }
            let inner = self.open(child);
            if inner.tag != "transform" {
                let message = format!("<{}> cannot be inside of <animation>", inner.tag);
                self.error("misplaced-element", message, inner.span);
            } else if self.check(&inner, &["time"], &[])
                && let Some((text, span)) = inner.get("time")
                && let Some(time) = self.report(parse_float(text), span)
                && let Some(map) = self.chain(child, &inner)
            {
                if map.inverse().is_none() {
                    self.error("bad-transform", "this transform is singular: it flattens space", inner.span);
                }
                keys.push((time as f32, map));
            }
        }
        let motion = Motion::new(keys.iter().copied());
        if motion.is_none() && self.diagnostics.list.len() == errors {
            let message = "an animation needs transforms, with times that ascend";
            self.error("bad-transform", message, element.span);
        }
        let value = motion.map_or(Value::Invalid, Value::Animation);
        self.add(parent, element, value, element.span);
    }

    /// Reads the maps in a `<transform>`; `None` where any is wrong.
    fn chain(&mut self, node: Node<'_, '_>, element: &Element) -> Option<Affine> {
        let errors = self.diagnostics.list.len();
        let mut total = Affine::IDENTITY;
        for child in node.children() {
            if !child.is_element() {
                self.refuse_text(child);
                continue;
            }
            let inner = self.open(child);
            if let Some(step) = self.step(&inner) {
                total = step.after(&total);
            }
            self.refuse_children(child, &inner.tag);
        }
        let representable = total.rows.iter().flatten().all(|v| (*v as f32).is_finite());
        if !representable {
            self.error(
                "bad-transform",
                "this transform has entries beyond the range of numbers",
                element.span,
            );
        }
        (representable && self.diagnostics.list.len() == errors).then_some(total)
    }

    fn step(&mut self, element: &Element) -> Option<Affine> {
        match element.tag.as_str() {
            "translate" => self.translate(element),
            "rotate" => self.rotate(element),
            "scale" => self.scale(element),
            "matrix" => self.matrix(element),
            "lookat" | "lookAt" => self.look_at(element),
            tag => {
                let message = format!("unknown element <{tag}> in a <transform>");
                let mut diagnostic = Diagnostic::error("unknown-element", message).at(element.span, "");
                let known = ["translate", "rotate", "scale", "matrix", "lookat"];
                diagnostic.help.extend(hint(tag, "known", &known));
                self.diagnostics.unsupported(diagnostic, "it is ignored");
                None
            }
        }
    }

    fn translate(&mut self, element: &Element) -> Option<Affine> {
        self.check(element, &[], &["x", "y", "z", "value"]);
        let [x, y, z] = self.xyz(element, Some(0.0))?;
        Some(Affine::translation(x, y, z))
    }

    fn scale(&mut self, element: &Element) -> Option<Affine> {
        self.check(element, &[], &["x", "y", "z", "value"]);
        let [x, y, z] = self.xyz(element, Some(1.0))?;
        Some(Affine::scaling(x, y, z))
    }

    fn rotate(&mut self, element: &Element) -> Option<Affine> {
        let complete = self.check(element, &["angle"], &["x", "y", "z", "value"]);
        let axis = self.xyz(element, Some(0.0))?;
        let (angle, angle_span) = element.get("angle").filter(|_| complete)?;
        let degrees = self.report(parse_float(angle), angle_span)?;
        if axis.iter().all(|a| *a == 0.0) {
            self.error("bad-transform", "a rotation needs an axis that is not zero", element.span);
            return None;
        }
        // Extreme axes would over- or underflow when squared; only the direction counts.
        let largest = axis.iter().fold(0.0f64, |m, a| m.max(a.abs()));
        Some(Affine::rotation(axis.map(|a| a / largest), degrees))
    }

    fn look_at(&mut self, element: &Element) -> Option<Affine> {
        if !self.check(element, &["origin", "target"], &["up"]) {
            return None;
        }
        let origin = self.point(element, "origin")?;
        let target = self.point(element, "target")?;
        let up = if element.has("up") { self.point(element, "up")? } else { [0.0; 3] };
        let direction: [f64; 3] = std::array::from_fn(|i| target[i] - origin[i]);
        let up = if up == [0.0; 3] { perpendicular_seed(direction) } else { up };
        let found = Affine::look_at(origin, target, up);
        if found.is_none() {
            let message = "origin and target are the same point, or the up vector lies along the view";
            self.error("bad-transform", message, element.span);
        }
        found
    }

    fn point(&mut self, element: &Element, name: &str) -> Option<[f64; 3]> {
        let (text, span) = element.get(name)?;
        let values = self.report(parse_floats(text), span)?;
        let found = values.try_into().map_err(|v: Vec<f64>| format!("3 numbers expected, got {}", v.len()));
        self.report(found, span)
    }

    /// 3x3 or 4x4, row by row, for column vectors.
    fn matrix(&mut self, element: &Element) -> Option<Affine> {
        if !self.check(element, &["value"], &[]) {
            return None;
        }
        let (text, span) = element.get("value")?;
        let v = self.report(parse_floats(text), span)?;
        let mut rows = Affine::IDENTITY.rows;
        match v.len() {
            9 => rows.iter_mut().zip(v.chunks(3)).for_each(|(row, m)| row[..3].copy_from_slice(m)),
            16 => {
                if v[12..15] != [0.0; 3] || v[15] == 0.0 {
                    let message =
                        "projective maps are not supported: the last row of a matrix must be 0 0 0 1";
                    self.error("bad-transform", message, span);
                    return None;
                }
                // A last row of 0 0 0 w is the same map as all entries over w.
                rows.iter_mut().zip(v.chunks(4)).for_each(|(row, m)| {
                    row.iter_mut().zip(m).for_each(|(out, entry)| *out = entry / v[15]);
                });
            }
            n => {
                self.error("bad-value", format!("9 or 16 numbers expected, got {n}"), span);
                return None;
            }
        }
        Some(Affine { rows })
    }

    fn report<T>(&mut self, found: Result<T, String>, span: Span) -> Option<T> {
        found.map_err(|message| self.error("bad-value", message, span)).ok()
    }
}

/// A vector that is not parallel to `direction`: the axis along which it is shortest.
fn perpendicular_seed(direction: [f64; 3]) -> [f64; 3] {
    let shortest = (0..3).min_by(|a, b| direction[*a].abs().total_cmp(&direction[*b].abs())).unwrap_or(0);
    std::array::from_fn(|i| f64::from(u8::from(i == shortest)))
}
