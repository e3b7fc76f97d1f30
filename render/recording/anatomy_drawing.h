#pragma once

#include <string>

#include "render/overlay/overlay_key.h"
#include "render/overlay/overlays.h"
#include "sim/tissue/tissue.h"

namespace condyle {

/// The sheet below a number of layers of soft tissue, at the present nodes.
GlassSheet layer_sheet(const TissueModel& model, const TissueState& now, int sheet,
                       double opacity = 0.5);
/// Entry for its colour.
KeyEntry layer_key(const TissueModel& model, int sheet);
/// "Fat" in the default three layers; "Fat, 2 of 2" where a fine mesh has divided it.
std::string layer_label(const TissueModel& model, int sheet);
/// For a narrow list.
std::string layer_short_label(const TissueModel& model, int sheet);
/// Name of an overlay: in the order of names inner sheets come first and outer ones are drawn over
/// them.
std::string layer_overlay_name(int sheet);

}  // namespace condyle
