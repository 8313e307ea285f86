use super::values;
use clap::Args;
use raycast_core::formats::Limits;
use raycast_core::scene::UpAxis;
use std::str::FromStr;

/// How files are read: limits, files that meshes name, the up axis.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Reading")]
pub struct ReadingArgs {
    /// Set a limit of reading: `bytes` in memory at one time [default: 4G], `pixels` of an image [default: 256M],
    /// `triangles` of the scene [default: 128M]; K, M, G are powers of 1024
    #[arg(long = "limit", value_name = "NAME=N")]
    pub limits: Vec<LimitArg>,
    /// Read a mesh's material libraries and textures from any folder, not only its own and the one above
    #[arg(long)]
    pub follow_anywhere: bool,
    /// The up axis of mesh files that do not say it (a scene file says it for its objects): z rotates (x, y, z) to (x,
    /// z, -y) [default: y]
    #[arg(long, value_name = "AXIS", value_parser = values::named(values::UP_AXES))]
    pub up_axis: Option<UpAxis>,
}

impl ReadingArgs {
    /// The defaults with the requested limits.
    pub fn limits(&self) -> Limits {
        let mut limits = Limits {
            follow_anywhere: self.follow_anywhere,
            up_axis: self.up_axis.unwrap_or_default(),
            ..Limits::default()
        };
        for limit in &self.limits {
            let place = match limit.kind {
                LimitKind::Bytes => &mut limits.bytes,
                LimitKind::Pixels => &mut limits.pixels,
                LimitKind::Triangles => &mut limits.triangles,
            };
            *place = limit.most;
        }
        limits
    }
}

/// A limit of reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LimitKind {
    Bytes,
    Pixels,
    Triangles,
}

/// `--limit`: the limit and its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitArg {
    kind: LimitKind,
    most: u64,
}

impl FromStr for LimitArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, number) = text.split_once('=').unwrap_or((text, ""));
        let kind = match name {
            "bytes" => LimitKind::Bytes,
            "pixels" => LimitKind::Pixels,
            "triangles" => LimitKind::Triangles,
            _ => return Err("expected bytes=N, pixels=N or triangles=N".to_owned()),
        };
        let shift = match number.as_bytes().last() {
            Some(b'k' | b'K') => 10,
            Some(b'm' | b'M') => 20,
            Some(b'g' | b'G') => 30,
            _ => 0,
        };
        let digits = &number[..number.len() - usize::from(shift > 0)];
        let most = digits
            .parse::<u64>()
            .ok()
            .and_then(|digits| digits.checked_mul(1 << shift));
        most.map(|most| Self { kind, most })
            .ok_or_else(|| format!("expected a whole number behind {name}=, with K, M or G"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_have_names_and_units() {
        let limit = |text: &str| text.parse::<LimitArg>();
        let args = ReadingArgs {
            limits: ["bytes=3G", "pixels=7", "triangles=2k", "pixels=1m"]
                .iter()
                .map(|text| limit(text).expect("a limit"))
                .collect(),
            follow_anywhere: true,
            up_axis: Some(UpAxis::Z),
        };
        let expected = Limits {
            bytes: 3 << 30,
            pixels: 1 << 20,
            triangles: 2048,
            follow_anywhere: true,
            up_axis: UpAxis::Z,
            stand_ins: false,
        };
        assert_eq!(args.limits(), expected);
        assert_eq!(ReadingArgs::default().limits(), Limits::default());
        for bad in [
            "",
            "bytes",
            "bytes=",
            "bytes=x",
            "bytes=-1",
            "rows=1",
            "bytes=99999999999G",
        ] {
            assert!(limit(bad).is_err(), "{bad}");
        }
        assert_eq!(limit("bytes=G").ok(), None);
    }
}
