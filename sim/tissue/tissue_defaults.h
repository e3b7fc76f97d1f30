#pragma once

namespace condyle::tissue_defaults {

// Constants of the soft tissue's supports. "Fitted" lists the patients on which the value was
// chosen so that the face opens without folds and returns: the built-in one (B), case-badin (C),
// the scan over scaled bones (S). The elasticity of the layers is defined in engine/tissue.

// Stiffness of the spring from a node to what carries it, N/mm, for a node of the default mesh;
// finer meshes divide it among their nodes.
constexpr double bone_stiffness = 2.0;       // grown on bone: about 50 times a skin spring
constexpr double rim_stiffness = 2.0;        // the cut towards the rest of the face
constexpr double cartilage_stiffness = 0.5;  // the nose; fitted (B, C)
/// The plates in the lids, which tendons hold at both canthi: whole up to the first distance from
/// the line between these, and not at all the second one farther, mm.
constexpr double lid_stiffness = 2.0, lid_mm = 6, lid_fades_mm = 6;
constexpr double neck_stiffness = 0.1;    // inner side of the throat; fitted (B, C)
constexpr double loose_stiffness = 0.15;  // loose tissue on both jaws; fitted (B, C)
/// Above the inner side under the chin: fat and platysma are connected to jaw and neck through
/// their whole depth. Without this the skin snaps from fold to fold as the mouth opens; fitted (B).
constexpr double platysma_stiffness = 0.05;
/// The muscles of a lip hold its inner side to its own jaw, so that it does not roll over the
/// teeth's edges; and, much less, the whole of its edge, which would buckle; fitted (B, C, S).
constexpr double lip_stiffness = 0.3, lip_edge_stiffness = 0.15;
/// Supports and contacts are stiff enough for tissue of up to this modulus, MPa: living tissue is
/// softer.
constexpr double supported_modulus_MPa = 0.1;

// Extents, mm from the line between the lips.
constexpr double lip_margin_mm = 14, lip_edge_mm = 6;
constexpr double side_reach_mm = 30;  // along the skin: where it is of the upper or lower lip

// The border of a face that ends below the jaw follows the mandible: fully up to this distance from
// it, and not at all a reach farther; fitted (C).
constexpr double border_full_mm = 15, border_reach_mm = 65;

// Motion of the displayed face is smoothed by this fraction where it is farther from the mouth than
// this, and less over the next mm: the coarse mesh of neck and jaw folds more sharply than skin;
// fitted (B, C).
constexpr double evened_fraction = 0.6, evened_from_mm = 35, evened_over_mm = 25;

// The opening path is solved at this many knots, to 43 degrees; the skin fold below the chin is
// sought at this opening.
constexpr int path_knots = 13;
constexpr double widest_rad = 0.75;

}  // namespace condyle::tissue_defaults
