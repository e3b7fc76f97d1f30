#include <fmt/format.h>

#include "tools/common.h"

namespace condyle {

int run_phantom(const std::filesystem::path& out, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = open_patient({}, common, bar);
  bar.clear();
  save_case(patient, out);
  if (!common.quiet)
    fmt::print(stderr, "{}: the built-in patient, {} parts, {} landmarks\n", out.string(),
               patient.parts.size(), patient.landmarks.points.size());
  return 0;
}

}  // namespace condyle
