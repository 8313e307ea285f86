use super::{ClipArgs, values};
use clap::Args;
use raycast_core::Cull;
use raycast_core::render::Precision;

/// How rays meet triangles.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Casting")]
pub struct CastingArgs {
    /// Workers, 0 to 256; 0 is one for each of the machine's
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads())]
    pub threads: u16,
    /// How sure a picture's triangles are [default: exact]
    #[arg(long, value_name = "KIND", value_parser = values::named(values::PRECISIONS))]
    pub precision: Option<Precision>,
    /// Which faces rays pass through: none, or those seen from the back [default: none]
    #[arg(long, value_name = "FACES", value_parser = values::named(values::CULLS))]
    pub cull: Option<Cull>,
    /// What is cut away.
    #[command(flatten)]
    pub clip: ClipArgs,
}
