#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/occlusion/occlusion.h"
#include "sim/operation_page/operation_tables.h"

namespace condyle {

/// A picture within a page.
struct PagePicture {
  std::string png;      // its bytes
  std::string caption;  // also its text for those who do not see it
};

/// What a page of a plan shows. It has no name of a case or plan and no path; names of segments,
/// parts and zones are the plan's.
struct OperationPage {
  const Plan& plan;
  const Operated& operated;
  const Prediction* prediction = nullptr;
  const OperationComparison* motion = nullptr;
  const Bite* bite = nullptr;  // after the operation
  std::string title = {};      // empty: made of the osteotomies
  std::string program, date;   // name and version; UTC
  std::string case_hash, plan_hash;
  std::vector<PagePicture> bones = {}, face = {}, bite_pictures = {};
  std::vector<std::string> graft_lines = {};  // of resections and grafts, see graft_report_text()
  bool shows_notes = false;                   // of the plan: they may name a person
  std::vector<std::string> remarks = {};      // what was left out, and why
};

/// The page as HTML: one file without scripts, pictures inside, for screen and A4 paper.
std::string operation_page(const OperationPage& page);

/// "Le Fort I, sagittal split", of the plan's steps.
std::string operation_title(const Plan& plan);

/// A step in the words of surgeons: "Le Fort I osteotomy; makes the maxilla".
std::string step_sentence(const PlanStep& step, const Operated& operated);

}  // namespace condyle
