#pragma once

#include "render/mesh/ambient_occlusion.h"
#include "sim/frame/part.h"

namespace condyle {

/// Ambient shade: bones of each body shade each other, at rest the other body too; the eyes lie
/// under the lids; the face is shaded by itself alone, since bones under it are invisible. Other
/// bodies have arbitrary poses: they neither cast nor receive shade from others.
void set_shade_layers(const Part& part, BodyId lower_jaw, OcclusionSurface& surface);

}  // namespace condyle
