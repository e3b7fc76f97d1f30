#pragma once

#include <string>
#include <utility>
#include <vector>

namespace condyle {

/// A page on which a browser shows a moving patient, without a network.
struct PatientPage {
  std::string title;               // such as "Mouth opening after the operation"
  std::string subtitle = {};       // below it
  std::string glb;                 // bytes of moving_patient()
  std::vector<double> times_s;     // of the opening, increasing; one entry: nothing moves
  std::vector<double> opening_mm;  // at those times
  struct Phase {
    std::string name;
    double start_s = 0, end_s = 0;
  };
  std::vector<Phase> phases = {};
  double face_opacity = 1;  // at first, 0 to 1
  std::string program;      // name and version
  std::string date;
  std::vector<std::pair<std::string, std::string>> hashes = {};  // "Case" and its hash
};

/// The page as HTML: one file with its script, style and the GLB inside. Its content security
/// policy forbids every request.
std::string patient_page(const PatientPage& page);

}  // namespace condyle
