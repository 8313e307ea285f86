use super::{ClipArgs, values};
use clap::Args;
use raycast_core::{Cull, Precision};

/// How rays are cast.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Casting")]
pub struct CastingArgs {
    /// Worker threads, 0 to 256; 0 is one for each hardware thread
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads())]
    pub threads: u16,
    /// How rays are decided that double precision leaves undecided: by exact arithmetic, or fast, by rounded signs
    /// [default: exact]
    #[arg(long, value_name = "KIND", value_parser = values::named(values::PRECISIONS))]
    pub precision: Option<Precision>,
    /// The faces that rays pass through: none, or back faces [default: none]
    #[arg(long, value_name = "FACES", value_parser = values::named(values::CULLS))]
    pub cull: Option<Cull>,
    /// The clipping planes.
    #[command(flatten)]
    pub clip: ClipArgs,
}
