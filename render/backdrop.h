#pragma once

namespace condyle {

/// What a picture shows where nothing is, and what all that is drawn or written on it is made for.
enum class Backdrop { dark, light };

}  // namespace condyle
