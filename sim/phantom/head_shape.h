#pragma once

#include <cstdint>
#include <string>

namespace condyle {

/// Which head is built: a variant of the built-in patient, a random head, or both.
struct HeadChoice {
  enum class Variant { standard, class_iii, scaphocephaly };
  Variant variant = Variant::standard;
  std::uint64_t seed = 0;  // 0: the dimensions of the built-in patient

  bool is_default() const { return variant == Variant::standard && seed == 0; }
};

/// "class-iii", "scaphocephaly"; "standard" for the built-in patient's own shape.
/// throws: InputError for another name, listing the known ones.
HeadChoice::Variant head_variant(const std::string& name);
std::string head_variant_names();

/// "built-in", then any of ":class-iii", ":scaphocephaly", ":seed=7"; as head_name() writes it.
/// throws: InputError for an unknown word.
HeadChoice parse_head_name(const std::string& name);
bool is_head_name(const std::string& name);
std::string head_name(const HeadChoice& choice);

/// Deviations from the built-in patient. mm, degrees.
struct HeadShape {
  double face_width = 0;    // bizygomatic, and the distance between the joints
  double gonial_width = 0;  // between the angles of the jaw
  double upper_height = 0;  // nasion to ANS; lowers both arches
  double chin_down = 0;     // menton below the lower arch
  double chin_forward = 0;  // pogonion relative to the lower arch
  double gonion_down = 0;   // length of the ramus
  double gonion_forward = 0;
  double maxilla_forward = 0;  // carries the lower arch along
  double bite_forward = 0;     // lower arch relative to the upper one: reduces the overjet
  double cant_deg = 0;         // of the occlusal plane; positive: left side down
  double nose_forward = 0, nose_width = 0;
  double vault_width = 0, vault_length = 0, vault_height = 0;
  double forehead_forward = 0;  // bossing
  double sagittal_ridge = 0;

  bool operator==(const HeadShape&) const = default;
};

/// Dimensions of a chosen head: those of its seed, drawn from published distributions and limited
/// to 1.8 standard deviations, plus those of its variant. The same on every machine.
HeadShape head_shape(const HeadChoice& choice);

}  // namespace condyle
