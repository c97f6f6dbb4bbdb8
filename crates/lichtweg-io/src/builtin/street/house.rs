//! Houses: four walls with windows, a door with steps, cornices and quoins, a roof with dormers and chimneys.

use super::builder::Builder;
use super::door::door;
use super::palette::{Material, PAINTS, PLASTERS};
use super::random::Random;
use super::roof::{Roof, chimney, downpipe};
use super::solids::{Rectangle, cuboid, prism, wall};
use super::window::{DEPTH, Surround, WindowStyle, window};

/// A house as it is decided upon.
#[derive(Clone, Copy, Debug)]
pub struct House {
    /// Along the street.
    pub width: f32,
    /// The middle of the door along the street, from the middle of the house.
    pub door: f32,
    depth: f32,
    storeys: u8,
    bays: usize,
    door_bay: usize,
    /// The gable, rather than the eaves, faces the street.
    gable_front: bool,
    plaster: Material,
    windows: WindowStyle,
    paint: Material,
    rise: f32,
    roof_tone: u8,
}

/// Height of a storey.
const STOREY: f32 = 3.0;
/// Height of the ground floor above the pavement.
const PLINTH: f32 = 0.45;

impl House {
    /// A house of some width.
    pub fn new(rng: &mut Random, width: f32) -> Self {
        let depth = rng.within(8.5..10.5);
        let gable_front = width < 8.2 && rng.chance(0.45);
        let span = if gable_front { width } else { depth };
        let bays = ((width - 0.6) / 2.1) as usize;
        let door_bay = usize::from(rng.below(bays as u8));
        let paint = Material::Paint(rng.below(PAINTS));
        let surrounds = [Surround::Band, Surround::Cornice, Surround::Keystone];
        let panes = [(2, 3), (2, 2), (3, 4), (2, 4)][usize::from(rng.below(4))];
        Self {
            width,
            door: (door_bay as f32 + 0.5) * width / bays as f32 - 0.5 * width,
            depth,
            bays,
            door_bay,
            storeys: 2 + u8::from(rng.chance(0.35)),
            gable_front,
            plaster: Material::Plaster(rng.below(PLASTERS)),
            windows: WindowStyle {
                columns: panes.0,
                rows: panes.1,
                shutters: rng.chance(0.5).then_some(paint),
                surround: surrounds[usize::from(rng.below(3))],
                stone: if rng.chance(0.5) { Material::Stone } else { Material::Trim },
            },
            paint,
            rise: 0.5 * span * rng.within(0.75..1.05),
            roof_tone: 3 * rng.below(2),
        }
    }

    fn eaves(&self) -> f32 {
        PLINTH + f32::from(self.storeys) * STOREY + 0.2
    }

    /// Builds it: the middle of the front at the origin, facing +z.
    pub fn build(&self, b: &mut Builder, rng: &mut Random) {
        self.front(b, rng);
        let (w, d) = (self.width, self.depth);
        b.at(0.5 * w, 0.0, -0.5 * d, |b| b.turned(90.0, |b| self.side(b, rng)));
        b.at(-0.5 * w, 0.0, -0.5 * d, |b| b.turned(-90.0, |b| self.side(b, rng)));
        b.at(0.0, 0.0, -d, |b| {
            b.turned(180.0, |b| wall(b, self.plaster, self.whole(w), &[], DEPTH));
        });
        self.roof(b, rng);
    }

    fn whole(&self, width: f32) -> Rectangle {
        Rectangle { x0: -0.5 * width, x1: 0.5 * width, y0: -0.1, y1: self.eaves() }
    }

    /// The windows of a wall, bay by bay; `door` leaves one bay of the ground floor out.
    fn openings(&self, width: f32, bays: usize, door: Option<usize>) -> Vec<Rectangle> {
        let bay = width / bays as f32;
        let half = 0.5 * if self.windows.shutters.is_some() { 0.95 } else { 1.1_f32.min(0.55 * bay) };
        let mut openings = Vec::new();
        for storey in 0..self.storeys {
            let floor = PLINTH + f32::from(storey) * STOREY;
            let height = [1.85, 1.7, 1.45][usize::from(storey)];
            for i in (0..bays).filter(|&i| storey > 0 || Some(i) != door) {
                let x = (i as f32 + 0.5) * bay - 0.5 * width;
                openings.push(Rectangle {
                    x0: x - half,
                    x1: x + half,
                    y0: floor + 0.8,
                    y1: floor + 0.8 + height,
                });
            }
        }
        openings
    }

    fn front(&self, b: &mut Builder, rng: &mut Random) {
        let windows = self.openings(self.width, self.bays, Some(self.door_bay));
        let way = Rectangle { x0: self.door - 0.55, x1: self.door + 0.55, y0: PLINTH, y1: PLINTH + 2.65 };
        let all: Vec<Rectangle> = windows.iter().copied().chain([way]).collect();
        wall(b, self.plaster, self.whole(self.width), &all, DEPTH);
        windows.iter().for_each(|o| window(b, rng, *o, &self.windows));
        door(b, rng, way, self.paint, self.windows.stone);
        self.bands(b, way);
        if self.gable_front {
            self.gable(b, rng, self.width);
        } else {
            let x = (0.5 * self.width - 0.18) * if rng.chance(0.5) { 1.0 } else { -1.0 };
            downpipe(b, x, self.eaves() - 0.2, 0.4);
        }
    }

    /// A plinth, bands between the storeys, a cornice, and quoins.
    fn bands(&self, b: &mut Builder, way: Rectangle) {
        let (half, stone) = (0.5 * self.width, self.windows.stone);
        for [x0, x1] in [[-half - 0.03, way.x0 - 0.14], [way.x1 + 0.14, half + 0.03]] {
            cuboid(b, Material::Stone, [x0, -0.1, -0.03], [x1, PLINTH - 0.02, 0.05]);
        }
        for storey in 1..self.storeys {
            let y = PLINTH + f32::from(storey) * STOREY;
            cuboid(b, stone, [-half - 0.04, y, -0.04], [half + 0.04, y + 0.2, 0.06]);
        }
        let top = self.eaves();
        if !self.gable_front {
            let profile = [
                [-0.04, top - 0.4],
                [0.05, top - 0.4],
                [0.08, top - 0.25],
                [0.22, top - 0.1],
                [0.22, top],
                [-0.04, top],
            ];
            b.turned(-90.0, |b| prism(b, stone, &profile, -half - 0.02, half + 0.02));
        }
        let courses = ((top - PLINTH) / 0.34) as usize;
        for i in 0..courses {
            let y = PLINTH + i as f32 * 0.34;
            let length = if i % 2 == 0 { 0.42 } else { 0.26 };
            for [x0, x1] in [[-half - 0.02, -half + length], [half - length, half + 0.02]] {
                cuboid(b, stone, [x0, y, -length], [x1, y + 0.31, 0.035]);
            }
        }
    }

    fn side(&self, b: &mut Builder, rng: &mut Random) {
        let mut openings = self.openings(self.depth, 3, None);
        openings.retain(|_| rng.chance(0.45));
        wall(b, self.plaster, self.whole(self.depth), &openings, DEPTH);
        openings.iter().for_each(|o| window(b, rng, *o, &self.windows));
        cuboid(b, Material::Stone, [-0.5 * self.depth, -0.1, 0.0], [0.5 * self.depth, PLINTH - 0.02, 0.04]);
        if !self.gable_front {
            self.gable(b, rng, self.depth);
        }
    }

    /// The triangle under the roof of the wall z = 0, with a small window.
    fn gable(&self, b: &mut Builder, rng: &mut Random, width: f32) {
        let (half, y) = (0.5 * width, self.eaves());
        prism(b, self.plaster, &[[-half, y], [half, y], [0.0, y + self.rise]], -0.2, 0.0);
        if width > 5.0 {
            let light = Rectangle { x0: -0.4, x1: 0.4, y0: y + 0.5, y1: y + 1.6 };
            let plain = WindowStyle { shutters: None, ..self.windows };
            b.at(0.0, 0.0, DEPTH + 0.02, |b| {
                cuboid(b, self.plaster, [-0.5, y + 0.4, -DEPTH], [0.5, y + 0.5, 0.0]);
                wall(
                    b,
                    self.plaster,
                    Rectangle { x0: -0.5, x1: 0.5, y0: y + 0.5, y1: y + 1.7 },
                    &[light],
                    DEPTH,
                );
                window(b, rng, light, &plain);
            });
        }
    }

    fn roof(&self, b: &mut Builder, rng: &mut Random) {
        let (length, span) =
            if self.gable_front { (self.depth, self.width) } else { (self.width, self.depth) };
        let roof = Roof { length: length + 0.24, span, rise: self.rise, overhang: 0.4, tone: self.roof_tone };
        b.at(0.0, self.eaves(), -0.5 * self.depth, |b| {
            b.turned(if self.gable_front { 90.0 } else { 0.0 }, |b| {
                roof.build(b, rng);
                for side in [-1.0, 1.0] {
                    if rng.chance(0.7) {
                        let x = side * (0.5 * length - rng.within(0.5..0.9));
                        let z = rng.jitter(0.12 * span);
                        b.at(x, 0.0, z, |b| {
                            let top = self.rise + rng.within(0.9..1.4);
                            chimney(b, rng, self.rise - 1.4, top)
                        });
                    }
                }
                if !self.gable_front {
                    self.dormers(b, rng);
                }
            });
        });
    }

    /// Small houses on the roof, their fronts above the eaves.
    fn dormers(&self, b: &mut Builder, rng: &mut Random) {
        let count = rng.below(4);
        let half_span = 0.5 * self.depth;
        let floor = 0.85;
        let z = half_span * (1.0 - floor / self.rise) + 0.3;
        for i in 0..count {
            let x = (f32::from(i) + 0.5) / f32::from(count) * (self.width - 2.0) - 0.5 * (self.width - 2.0);
            b.at(x, floor, z, |b| self.dormer(b, rng, z));
        }
    }

    fn dormer(&self, b: &mut Builder, rng: &mut Random, z: f32) {
        let (half, height, depth) = (0.62, 1.25, z.min(2.6));
        let light = Rectangle { x0: -0.42, x1: 0.42, y0: 0.12, y1: 1.15 };
        let front = Rectangle { x0: -half, x1: half, y0: -0.5, y1: height };
        wall(b, Material::Trim, front, &[light], DEPTH);
        let plain =
            WindowStyle { shutters: None, surround: Surround::Band, columns: 2, rows: 2, ..self.windows };
        window(b, rng, light, &plain);
        for [x0, x1] in [[-half, -half + 0.05], [half - 0.05, half]] {
            cuboid(b, Material::Zinc, [x0, -0.5, -depth], [x1, height, -0.001]);
        }
        prism(b, Material::Trim, &[[-half, height], [half, height], [0.0, height + 0.55]], -0.1, 0.0);
        let roof =
            Roof { length: depth + 0.2, span: 2.0 * half, rise: 0.55, overhang: 0.12, tone: self.roof_tone };
        b.at(0.0, height, 0.1 - 0.5 * depth, |b| b.turned(90.0, |b| roof.build(b, rng)));
    }
}
