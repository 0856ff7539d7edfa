//! Wrong implementations of public traits, each a mistake that someone made or could make.

mod boundaries;
mod densities;
mod engines;
mod estimators;
mod kernels;
mod neighbours;
mod randomness;
mod selectors;
mod statements;

use super::Fault;

/// Every fault; to add one, add a line.
pub const FAULTS: &[Fault] = &[
    randomness::SEED_IGNORED,
    randomness::PURPOSE_IGNORED,
    randomness::STREAM_REUSED,
    randomness::SAMPLE_REUSED,
    randomness::ANTITHETIC,
    densities::WIDE_DRAWS,
    densities::QUANTILE_OFF,
    densities::TOO_HIGH,
    densities::CURVATURE_OFF,
    kernels::ROUGHNESS_OFF,
    kernels::TOO_HIGH,
    kernels::MOMENT_SIGN,
    engines::FULL_WIDTH,
    engines::TAILS_CUT,
    engines::POINT_LOST,
    engines::PRODUCT_CONSTANT,
    boundaries::HALF_LOST,
    boundaries::MIRROR_LOST,
    boundaries::CORNER_COPY_LOST,
    boundaries::SLOPE_LOST,
    boundaries::WRAP_LOST,
    estimators::ONE_PERCENT,
    estimators::PLANE_TWO_PERCENT,
    estimators::BANDWIDTH_OFF,
    estimators::EVERY_OTHER_POINT,
    estimators::WEIGHTS_IGNORED,
    estimators::HITS_FOR_PATHS,
    estimators::BIN_EDGE_OFF,
    estimators::POINTS_LESS_ONE,
    neighbours::K_FOR_K_LESS_ONE,
    neighbours::SHELL_OFF,
    neighbours::SQUARE_FOR_DISC,
    neighbours::WRAP_LOST,
    neighbours::NEXT_NEIGHBOUR,
    selectors::BARE_COUNT,
    selectors::OWN_POINT_KEPT,
    statements::PARITY_SPLIT,
    statements::HALF_FOR_QUARTER,
    statements::BIASED_BATCHES,
    statements::BIASED_VARIANCE,
    statements::NORMAL_FOR_STUDENT,
];
