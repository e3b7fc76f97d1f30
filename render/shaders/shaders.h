#pragma once

#include <compare>
#include <string>

namespace condyle {

/// GLSL 3.30 sources. Their uniforms are set in lights.cpp, material.cpp and passes.cpp.
struct ShaderSource {
  std::string vertex, fragment;
};

/// Variant of a shader. Fixed at compilation: without a GPU both sides of a branch are executed for
/// every pixel.
struct Shading {
  bool shadowed = false, mapped = false, coated = false, cuttable = false, seen_through = false;
  bool skin = false;         // otherwise bone, teeth, eyes, ...: type of the stored pixels
  bool smooth_skin = false;  // without pores or papillae
  bool papillae = false;     // of a tongue
  bool vanishing = false;    // skin of a neck that vanishes towards its cut
  bool deferred = false;     // lights stored pixels (see surface_buffer.h)
  auto operator<=>(const Shading&) const = default;
};

ShaderSource surface_shaders(const Shading&);  // bone, teeth, eyes, gums, tongue
ShaderSource skin_shaders(const Shading&);     // outer side of the face
// its inner side, visible through the mouth or from behind
ShaderSource interior_shaders(const Shading&);
ShaderSource keep_shaders(const Shading&);  // inputs of lighting, per pixel
ShaderSource carry_shaders();               // copies the lit pixels, surface by surface
ShaderSource place_shaders();               // or all at once
ShaderSource blend_shaders();               // blends lit pixels of one surface
ShaderSource edge_shaders();                // marks the pixels with edges of surfaces
ShaderSource inner_shaders();               // copies the others into every sample
ShaderSource depth_shaders();  // only depth: shadow map and prepass of translucent parts
ShaderSource background_shaders();
ShaderSource marker_shaders();  // contact points and dots
ShaderSource line_shaders();
ShaderSource cap_shaders();    // the plane that closes a cut solid
ShaderSource tint_shaders();   // ghosts and wireframes
ShaderSource fibre_shaders();  // muscles

}  // namespace condyle
