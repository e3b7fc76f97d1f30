#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/case/muscle.h"

namespace condyle {

/// A table of muscles: CSV with the columns name, origin_body, insertion_body, ox_mm, oy_mm, oz_mm,
/// ix_mm, iy_mm, iz_mm, max_force_N; optionally abbrev, full_name, group, opt_length_mm (else
/// the length at rest), max_length_mm (else 1.3 times that), tendon_ratio (0) and passive_fraction
/// (0.015). Bodies: cranium, maxilla, skull; jaw, mandible; hyoid; thyroid, cricoid, sternum, neck.
/// Muscles of other bodies, and those that move neither mandible nor hyoid, are omitted with an
/// entry in `notes`. Points are as given in the file.
/// throws: InputError with file, line, column and value; when no muscle is left.
std::vector<Muscle> read_muscles(const std::filesystem::path& file,
                                 std::vector<std::string>& notes);

/// The muscles as CSV text with exact round trip.
std::string muscles_csv(const std::vector<Muscle>& muscles);

}  // namespace condyle
