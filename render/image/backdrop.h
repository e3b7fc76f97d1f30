#pragma once

namespace condyle {

/// Background of a picture; overlays and text are coloured to suit it.
enum class Backdrop { dark, light };

}  // namespace condyle
