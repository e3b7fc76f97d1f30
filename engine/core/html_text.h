#pragma once

#include <string>
#include <string_view>

namespace condyle {

/// Text for SVG and HTML, in elements and in quoted attributes.
std::string escaped(std::string_view text);

/// Base64 with padding, without line breaks.
std::string base64(std::string_view bytes);

/// JSON text that can stand in a `<script>` element: it holds no "<", so that it cannot end it.
std::string json_for_script(std::string_view json);

}  // namespace condyle
