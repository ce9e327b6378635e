//! What a 3-D view shows: two frames that fly, truth and estimate, and the line.

use super::{nanos, stamp};
use crate::ulog::Data;
use foxglove::messages::line_primitive::Type;
use foxglove::messages::{
    Color, FrameTransform, FrameTransforms, LinePrimitive, Point3, Quaternion, SceneEntity,
    SceneUpdate, Timestamp, Vector3,
};
use foxglove::{Channel, Context, PartialMetadata};
use std::sync::Arc;

/// East, North, Up round the anchor: viewers draw the third axis upwards.
const MAP: &str = "map";
/// North, East, Down round the anchor, as the log's numbers are.
const ANCHOR: &str = "anchor";
/// Half of an arm that is drawn, m.
const ARM: f64 = 0.2;
/// The same instants are drawn once: the log has them at up to 100 Hz.
const PERIOD: u64 = 20_000;

const BLACK: Color = Color { r: 0.1, g: 0.1, b: 0.1, a: 1.0 };
const RED: Color = Color { r: 0.8, g: 0.1, b: 0.1, a: 0.7 };

/// Who flies, and in which topics its pose is.
struct Body {
    frame: &'static str,
    position: &'static str,
    attitude: &'static str,
    color: Color,
    /// Body FRD to NED, w x y z.
    quaternion: Option<[f64; 4]>,
    drawn: Option<u64>,
}

impl Body {
    const fn new(frame: &'static str, topics: [&'static str; 2], color: Color) -> Self {
        let [position, attitude] = topics;
        Self { frame, position, attitude, color, quaternion: None, drawn: None }
    }
}

/// The channels of the view, and what is known so far.
pub struct Scene {
    frames: Channel<FrameTransforms>,
    scene: Channel<SceneUpdate>,
    bodies: [Body; 2],
    has_map: bool,
}

fn transform(
    at: Timestamp,
    [parent, child]: [&str; 2],
    [x, y, z]: [f64; 3],
    [w, i, j, k]: [f64; 4],
) -> FrameTransform {
    FrameTransform {
        timestamp: Some(at),
        parent_frame_id: parent.into(),
        child_frame_id: child.into(),
        translation: Some(Vector3 { x, y, z }),
        rotation: Some(Quaternion { x: i, y: j, z: k, w }),
    }
}

fn lines(points: &[[f64; 3]], thickness: f64, color: Color) -> LinePrimitive {
    LinePrimitive {
        r#type: Type::LineList.into(),
        thickness,
        color: Some(color),
        points: points.iter().map(|&[x, y, z]| Point3 { x, y, z }).collect(),
        ..LinePrimitive::default()
    }
}

fn entity(at: Timestamp, frame: &str, id: &str, lines: LinePrimitive) -> SceneEntity {
    SceneEntity {
        timestamp: Some(at),
        frame_id: frame.into(),
        id: id.into(),
        frame_locked: true,
        lines: vec![lines],
        ..SceneEntity::default()
    }
}

impl Scene {
    pub fn new(context: &Arc<Context>) -> Self {
        Self {
            frames: context.channel_builder("/tf").build(),
            scene: context.channel_builder("/scene").build(),
            bodies: [
                Body::new(
                    "vehicle",
                    ["vehicle_local_position_groundtruth", "vehicle_attitude_groundtruth"],
                    BLACK,
                ),
                Body::new("estimate", ["vehicle_local_position", "vehicle_attitude"], RED),
            ],
            has_map: false,
        }
    }

    /// A pose is drawn when its position comes, with the last attitude.
    pub fn sample(&mut self, data: &Data, time: u64) {
        for body in &mut self.bodies {
            if data.topic == body.attitude {
                body.quaternion = data.numbers("q").and_then(|q| q.try_into().ok());
            }
            if data.topic != body.position
                || data.number("xy_valid") == Some(0.0)
                || body.drawn.is_some_and(|drawn| time < drawn.saturating_add(PERIOD))
            {
                continue;
            }
            let [x, y, z] = ["x", "y", "z"].map(|axis| data.number(axis));
            let (Some(x), Some(y), Some(z), Some(quaternion)) = (x, y, z, body.quaternion) else {
                continue;
            };
            body.drawn = Some(time);
            let (at, meta) = (stamp(time), PartialMetadata::with_log_time(nanos(time)));
            let mut transforms = vec![transform(at, [ANCHOR, body.frame], [x, y, z], quaternion)];
            if !self.has_map {
                // Half a turn round the diagonal of North and East.
                let half = std::f64::consts::FRAC_1_SQRT_2;
                transforms.push(transform(at, [MAP, ANCHOR], [0.0; 3], [0.0, half, half, 0.0]));
                self.has_map = true;
            }
            self.frames.log_with_meta(&FrameTransforms { transforms }, meta);
            let arms = [[ARM, ARM, 0.0], [-ARM, -ARM, 0.0], [ARM, -ARM, 0.0], [-ARM, ARM, 0.0]];
            let line = lines(&[[0.0; 3], [x, y, z]], 0.01, body.color);
            let line = entity(at, ANCHOR, &format!("{} line", body.frame), line);
            let arms = entity(at, body.frame, body.frame, lines(&arms, 0.03, body.color));
            let update = SceneUpdate { entities: vec![line, arms], ..SceneUpdate::default() };
            self.scene.log_with_meta(&update, meta);
        }
    }
}
