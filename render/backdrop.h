#pragma once

namespace condyle {

/// What a picture shows where nothing is; `none` leaves it transparent.
enum class Backdrop { dark, light, none };

}  // namespace condyle
