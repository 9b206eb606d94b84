//! The hull of motions the robot may be executing: measured, in flight, and the new one.

use crate::arith::{magnitude, narrow};
use crate::input::Twist;
use crate::units::{AngularSpeed, Curvature, Speed};

/// Room for measured, commands in flight, the last one before those, and the new one.
pub const VERTICES_MAX: usize = 40;

/// One corner of the hull. For an Ackermann drive the curvature is that of the wheels,
/// which means something at standstill, too; for a differential drive it is unused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Vertex {
    /// Speed and turn rate.
    pub twist: Twist,
    /// Curvature of the steered wheels.
    pub curvature: Curvature,
}

/// A bounded set of motions whose convex hull contains whatever the robot may do.
#[derive(Clone, Copy, Debug)]
pub struct Hull {
    vertices: [Vertex; VERTICES_MAX],
    count: usize,
    overflow: bool,
}

impl Default for Hull {
    fn default() -> Self {
        Self {
            vertices: [Vertex::default(); VERTICES_MAX],
            count: 0,
            overflow: false,
        }
    }
}

impl Hull {
    /// Adds a motion. A full hull remembers that it is incomplete; such a hull is never certified.
    pub fn push(&mut self, vertex: Vertex) {
        match self.vertices.get_mut(self.count) {
            Some(slot) => {
                *slot = vertex;
                self.count = self.count.saturating_add(1);
            }
            None => self.overflow = true,
        }
    }

    /// Declares that motions are missing; such a hull is never certified.
    pub const fn mark_incomplete(&mut self) {
        self.overflow = true;
    }

    /// Whether every motion found room.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        !self.overflow
    }

    /// The motions added so far.
    pub fn vertices(&self) -> impl Iterator<Item = &Vertex> {
        self.vertices.iter().take(self.count)
    }

    /// The same motions seen by a robot that drives backwards: both signs flip, curvatures stay.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mut out = *self;
        for vertex in out.vertices.iter_mut().take(self.count) {
            vertex.twist = Twist {
                linear: Speed::from_um_per_s(vertex.twist.linear.as_um_per_s().saturating_neg()),
                angular: AngularSpeed::from_urad_per_s(
                    vertex.twist.angular.as_urad_per_s().saturating_neg(),
                ),
            };
        }
        out
    }

    /// The corners of the bounding box: what a drive may do that ramps v and ω each by itself.
    #[must_use]
    pub fn boxed(&self) -> Self {
        let (v_min, v_max) = self.speed_range();
        let turn = |vertex: &Vertex| vertex.twist.angular.as_urad_per_s();
        let w_min = self.vertices().map(turn).min().unwrap_or(0);
        let w_max = self.vertices().map(turn).max().unwrap_or(0);
        let mut out = Self {
            overflow: self.overflow,
            ..Self::default()
        };
        for (v, w) in [
            (v_min, w_min),
            (v_min, w_max),
            (v_max, w_min),
            (v_max, w_max),
        ] {
            out.push(Vertex {
                twist: Twist {
                    linear: Speed::from_um_per_s(v),
                    angular: AngularSpeed::from_urad_per_s(w),
                },
                curvature: Curvature::ZERO,
            });
        }
        out
    }

    /// Least and largest speed in µm/s; zeros for the empty hull.
    #[must_use]
    pub fn speed_range(&self) -> (i32, i32) {
        let speed = |vertex: &Vertex| vertex.twist.linear.as_um_per_s();
        (
            self.vertices().map(speed).min().unwrap_or(0),
            self.vertices().map(speed).max().unwrap_or(0),
        )
    }

    /// Largest turn rate as a magnitude, µrad/s.
    #[must_use]
    pub fn turn_max(&self) -> u64 {
        self.vertices()
            .map(|vertex| magnitude(vertex.twist.angular.as_urad_per_s()))
            .max()
            .unwrap_or(0)
    }

    /// Largest turn rate in one direction (`sign` +1 or −1), at least zero, µrad/s.
    #[must_use]
    pub fn turn_towards(&self, sign: i32) -> u64 {
        self.vertices()
            .map(|vertex| {
                let turn = vertex.twist.angular.as_urad_per_s().saturating_mul(sign);
                u64::from(turn.max(0).unsigned_abs())
            })
            .max()
            .unwrap_or(0)
    }

    /// Interval of ω/v over the vertices at least half as fast as the fastest, µrad/m, outward.
    ///
    /// Any interval is sound, since what does not fit goes into
    /// [`Self::curvature_residual`]; slow vertices would only make it wide.
    #[must_use]
    pub fn curvature_interval(&self) -> CurvatureInterval {
        let half = self.speed_range().1.max(1).div_euclid(2).max(1);
        let mut out: Option<CurvatureInterval> = None;
        for vertex in self.vertices() {
            let v = i64::from(vertex.twist.linear.as_um_per_s());
            if v < i64::from(half) {
                continue;
            }
            let scaled = i64::from(vertex.twist.angular.as_urad_per_s()).saturating_mul(1_000_000);
            let low = scaled.checked_div_euclid(v).unwrap_or(i64::MIN);
            let one = CurvatureInterval {
                low: narrow(low),
                high: narrow(low.saturating_add(1)),
            };
            out = Some(out.map_or(one, |all| all.joined(one)));
        }
        out.unwrap_or_default()
    }

    /// Interval of the wheels' curvatures, µrad/m.
    #[must_use]
    pub fn wheel_interval(&self) -> CurvatureInterval {
        let wheel = |vertex: &Vertex| vertex.curvature.as_urad_per_m();
        CurvatureInterval {
            low: self.vertices().map(wheel).min().unwrap_or(0),
            high: self.vertices().map(wheel).max().unwrap_or(0),
        }
    }

    /// Largest distance of ω from `[low·v, high·v]` over the vertices, µrad/s, rounded up.
    #[must_use]
    pub fn curvature_residual(&self, interval: CurvatureInterval) -> u64 {
        self.vertices()
            .map(|vertex| {
                let v = i64::from(vertex.twist.linear.as_um_per_s().max(0));
                let w = i64::from(vertex.twist.angular.as_urad_per_s());
                let low = i64::from(interval.low)
                    .saturating_mul(v)
                    .div_euclid(1_000_000);
                let high = i64::from(interval.high)
                    .saturating_mul(v)
                    .div_euclid(1_000_000);
                let below = low.saturating_add(1).saturating_sub(w);
                let above = w.saturating_sub(high);
                below.max(above).max(0).unsigned_abs()
            })
            .max()
            .unwrap_or(0)
    }
}

/// A closed interval of path curvatures in µrad/m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CurvatureInterval {
    /// Least curvature.
    pub low: i32,
    /// Largest curvature.
    pub high: i32,
}

impl CurvatureInterval {
    /// The least interval containing both.
    #[must_use]
    pub fn joined(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// The interval widened by `margin` on both ends.
    #[must_use]
    pub fn widened(self, margin: i32) -> Self {
        Self {
            low: self.low.saturating_sub(margin),
            high: self.high.saturating_add(margin),
        }
    }

    /// Largest magnitude.
    #[must_use]
    pub fn magnitude(self) -> u64 {
        magnitude(self.low).max(magnitude(self.high))
    }

    /// Midpoint, rounded down.
    #[must_use]
    pub fn middle(self) -> i32 {
        narrow(
            i64::from(self.low)
                .saturating_add(i64::from(self.high))
                .div_euclid(2),
        )
    }
}
