//! Affine maps that change with time.
//!
//! Each key A x + t is decomposed into a translation t, a rotation R and a symmetric stretch S with A = R S (polar
//! decomposition by Higham's iteration, *Computing the Polar Decomposition*, SIAM J. Sci. Stat. Comput. 7(4), 1986;
//! for this use: Shoemake and Duff, *Matrix Animation and Polar Decomposition*, Graphics Interface 1992). Between
//! keys t and S are interpolated linearly, R along the shorter great arc of unit quaternions. Between a key that
//! mirrors and one that does not, S passes through singular maps.

use super::{Affine, Bounds3};

/// An affine map through keys at ascending times; constant before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    keys: Vec<Key>,
}

#[derive(Clone, Debug, PartialEq)]
struct Key {
    time: f64,
    map: Affine,
    stretch: [[f64; 3]; 3],
    /// Unit quaternion (w, x, y, z), on the same hemisphere as that of the key before.
    rotation: [f64; 4],
    /// Angle on the sphere of quaternions from this key to the next: half that of the rotation.
    arc: f64,
}

impl Motion {
    /// A motion through keys of (time, map). `None` where there are none, times are not finite or do not ascend, or a
    /// map is singular or not finite.
    pub fn new(keys: impl IntoIterator<Item = (f32, Affine)>) -> Option<Self> {
        let mut all: Vec<Key> = Vec::new();
        for (time, map) in keys {
            let time = f64::from(time);
            let mut key = Key::new(time, map).filter(|_| time.is_finite())?;
            if let Some(last) = all.last_mut() {
                if last.time >= time {
                    return None;
                }
                let cosine = dot(&last.rotation, &key.rotation);
                if cosine < 0.0 {
                    key.rotation = key.rotation.map(|x| -x);
                }
                last.arc = cosine.abs().min(1.0).acos();
            }
            all.push(key);
        }
        (!all.is_empty()).then_some(Self { keys: all })
    }

    /// The map at a time.
    pub fn at(&self, time: f32) -> Affine {
        let time = f64::from(time);
        let after = self.keys.partition_point(|k| k.time <= time);
        if after == 0 || after == self.keys.len() {
            return self.keys[after.saturating_sub(1)].map;
        }
        let (a, b) = (&self.keys[after - 1], &self.keys[after]);
        let part = (time - a.time) / (b.time - a.time);
        if part <= 0.0 { a.map } else { a.towards(b, part) }
    }

    /// The times of the keys and their maps.
    pub fn keys(&self) -> impl ExactSizeIterator<Item = (f32, &Affine)> {
        self.keys.iter().map(|k| (k.time as f32, &k.map))
    }

    /// A box around all images of a box at the times in [0, 1].
    ///
    /// The path of a corner x is p = R S x + t. Where the rotation turns by the angle w over a segment, its second
    /// derivative is at most w^2 |S x| + 2 w |S' x|, and an arc of parameter length h leaves its chord by at most
    /// h^2 / 8 of that.
    pub fn bounds(&self, b: &Bounds3) -> Bounds3 {
        let mut out = self.at(0.0).bounds(b).union(self.at(1.0).bounds(b));
        if b.is_empty() {
            return Bounds3::EMPTY;
        }
        for pair in self.keys.windows(2) {
            let [first, second] = pair else { continue };
            let span = second.time - first.time;
            let [from, to] = [0.0, 1.0].map(|time| ((time - first.time) / span).clamp(0.0, 1.0));
            if from < to {
                out = out.union(first.swept(second, from, to, b));
            }
        }
        out
    }
}

impl Key {
    fn new(time: f64, map: Affine) -> Option<Self> {
        map.inverse()?;
        let linear = map.rows.map(|r| [r[0], r[1], r[2]]);
        let rotation = nearest_rotation(&linear)?;
        let stretch = times(&transposed(&rotation), &linear);
        Some(Self { time, map, stretch, rotation: quaternion(&rotation), arc: 0.0 })
    }

    /// The map at a fraction of the way to the next key.
    fn towards(&self, next: &Self, part: f64) -> Affine {
        let mix = |a: f64, b: f64| a + (b - a) * part;
        let sine = self.arc.sin();
        let (wa, wb) = if sine > 1e-9 {
            (((1.0 - part) * self.arc).sin() / sine, (part * self.arc).sin() / sine)
        } else {
            (1.0 - part, part)
        };
        let q: [f64; 4] = std::array::from_fn(|i| wa * self.rotation[i] + wb * next.rotation[i]);
        let stretch =
            std::array::from_fn(|r| std::array::from_fn(|c| mix(self.stretch[r][c], next.stretch[r][c])));
        let linear = times(&matrix(q), &stretch);
        Affine {
            rows: std::array::from_fn(|r| {
                let [a, b, c] = linear[r];
                [a, b, c, mix(self.map.rows[r][3], next.map.rows[r][3])]
            }),
        }
    }

    /// A box around the images of `b` between two fractions of the way to the next key.
    fn swept(&self, next: &Self, from: f64, to: f64, b: &Bounds3) -> Bounds3 {
        let angle = 2.0 * self.arc;
        let pieces = 1 + (8.0 * angle) as usize;
        let mut out = Bounds3::EMPTY;
        for i in 0..=pieces {
            let part = from + (to - from) * (i as f64 / pieces as f64);
            out = out.union(self.towards(next, part).bounds(b));
        }
        let mut bend = 0.0_f64;
        for corner in b.corners() {
            let x = corner.to_array().map(f64::from);
            let (s, e) = (apply(&self.stretch, x), apply(&next.stretch, x));
            let change = length([e[0] - s[0], e[1] - s[1], e[2] - s[2]]);
            bend = bend.max(angle * angle * length(s).max(length(e)) + 2.0 * angle * change);
        }
        let step = (to - from) / pieces as f64;
        out.widened((bend * step * step / 8.0 * 1.000_001) as f32)
    }
}

type Matrix = [[f64; 3]; 3];

/// The rotation R of A = R S with S symmetric, definite of either sign.
fn nearest_rotation(a: &Matrix) -> Option<Matrix> {
    let mut r = *a;
    for _ in 0..100 {
        let inverse = Affine { rows: r.map(|[x, y, z]| [x, y, z, 0.0]) }.inverse()?;
        let inverse = transposed(&inverse.rows.map(|[x, y, z, _]| [x, y, z]));
        // Scaling by norms makes far matrices converge fast (Higham, section 3).
        let scale = (norm(&inverse) / norm(&r)).sqrt();
        let next: Matrix =
            std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (scale * r[i][j] + inverse[i][j] / scale)));
        let change: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| next[i][j] - r[i][j]));
        r = next;
        if norm(&change) < 1e-14 {
            break;
        }
    }
    let determinant = Affine { rows: r.map(|[x, y, z]| [x, y, z, 0.0]) }.determinant();
    let sign = determinant.signum();
    ((determinant.abs() - 1.0).abs() < 1e-6).then(|| r.map(|row| row.map(|x| x * sign)))
}

/// The unit quaternion of a rotation, by its largest component (Shepperd 1978).
fn quaternion(r: &Matrix) -> [f64; 4] {
    let [x, y, z] = [r[0][0], r[1][1], r[2][2]];
    // Four times the squares of the components.
    let squares = [1.0 + x + y + z, 1.0 + x - y - z, 1.0 - x + y - z, 1.0 - x - y + z];
    let largest = (0..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let [a, b, c] = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
    let [d, e, f] = [r[1][0] + r[0][1], r[0][2] + r[2][0], r[2][1] + r[1][2]];
    let square = squares[largest];
    let q = [[square, a, b, c], [a, square, d, e], [b, d, square, f], [c, e, f, square]][largest];
    let n = dot(&q, &q).sqrt();
    q.map(|v| v / n)
}

/// The rotation of a quaternion of any length.
fn matrix(q: [f64; 4]) -> Matrix {
    let n = dot(&q, &q).sqrt();
    let [w, x, y, z] = q.map(|v| v / n);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn apply(m: &Matrix, x: [f64; 3]) -> [f64; 3] {
    m.map(|r| dot(&r, &x))
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn length(x: [f64; 3]) -> f64 {
    dot(&x, &x).sqrt()
}

/// Frobenius norm.
fn norm(m: &Matrix) -> f64 {
    m.iter().map(|r| dot(r, r)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    fn near(a: &Affine, b: &Affine, tolerance: f64) -> bool {
        a.rows.as_flattened().iter().zip(b.rows.as_flattened()).all(|(x, y)| (x - y).abs() < tolerance)
    }

    #[test]
    fn rotations_turn_at_constant_speed() {
        let turn = |degrees| Affine::rotation([1.0, 2.0, -0.5], degrees);
        let scale = Affine::scaling(2.0, 2.0, 2.0);
        let motion =
            Motion::new([(0.25, turn(10.0).after(&scale)), (0.75, turn(150.0).after(&scale))]).unwrap();
        assert!(near(&motion.at(0.5), &turn(80.0).after(&scale), 1e-12));
        assert!(near(&motion.at(0.3), &turn(24.0).after(&scale), 1e-6));
        assert_eq!(motion.at(-3.0), turn(10.0).after(&scale));
        assert_eq!(motion.at(0.75), turn(150.0).after(&scale));
    }

    #[test]
    fn keys_decompose_and_compose() {
        let shear = Affine { rows: [[1.0, 0.7, 0.0, 3.0], [0.0, -2.0, 0.1, 4.0], [0.5, 0.0, 0.25, -5.0]] };
        let keys = [(0.0, shear), (1.0, Affine::rotation([0.0, 0.0, 1.0], 179.0).after(&shear))];
        let motion = Motion::new(keys).unwrap();
        for (key, (_, map)) in motion.keys.iter().zip(keys) {
            assert!(near(&key.towards(key, 0.5), &map, 1e-12));
        }
        assert!(Motion::new([(0.0, Affine::scaling(1.0, 0.0, 1.0))]).is_none());
        assert!(Motion::new([(0.0, shear), (0.0, shear)]).is_none());
        assert!(Motion::new([(f32::NAN, shear)]).is_none());
        assert!(Motion::new([]).is_none());
    }

    #[test]
    fn bounds_hold_all_times() {
        let b = Bounds3 { min: Vec3::new(-1.0, 2.0, 0.0), max: Vec3::new(0.5, 3.0, 4.0) };
        let first = Affine::translation(1.0, 0.0, 0.0).after(&Affine::scaling(1.0, 2.0, 0.5));
        let second = Affine::rotation([0.3, 1.0, 0.2], 170.0).after(&Affine::scaling(3.0, 1.0, 1.0));
        let motion = Motion::new([(-0.5, first), (0.4, second), (0.9, Affine::IDENTITY)]).unwrap();
        let hull = motion.bounds(&b);
        let mut exact = Bounds3::EMPTY;
        for i in 0..=1000 {
            exact = exact.union(motion.at(i as f32 / 1000.0).bounds(&b));
        }
        for axis in 0..3 {
            assert!(hull.min[axis] <= exact.min[axis] && hull.max[axis] >= exact.max[axis]);
        }
        assert!(hull.half_area() < 1.02 * exact.half_area());
    }
}
