#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "render/image/image.h"
#include "sim/operation_page/operation_tables.h"
#include "sim/prediction/prediction.h"

namespace condyle {

/// The files of one operation: plan.json, the segments as PLY, the patient after it as a case,
/// pictures, report.json and report.html. Pictures are left out, with a note, where no OpenGL
/// context can be created.
class OperationOutput {
 public:
  /// `title` and `introduction`: of the page; the introduction is one paragraph of text.
  OperationOutput(std::filesystem::path folder, std::string title, std::string introduction);

  const std::filesystem::path& folder() const { return folder_; }

  /// Writes plan, segments and case, and adds the segments' sheet to the page. `soft`: landmarks of
  /// the predicted face, for cephalometry after the operation; without them it has bone alone.
  void add_operation(const Plan& plan, const Operated& operated, const Progress& progress,
                     const std::optional<Landmarks>& soft = {},
                     std::vector<std::string> views = {"front", "three-quarter", "left"});
  /// Writes the faces and the sheet of both.
  void add_prediction(const Plan& plan, const Prediction& prediction, const Progress& progress);
  /// Writes a picture and puts it on the page.
  void add_picture(const std::string& file, const Image& image, const std::string& caption);
  /// A heading with a paragraph.
  void add_section(const std::string& heading, const std::string& text);
  void add_table(const std::string& heading, const PageTable& table, const std::string& below = "");
  void add_link(const std::string& file, const std::string& text);
  void add_note(const std::string& note);
  /// Runs a function that draws, if drawing is possible.
  void draw(const std::function<void()>& drawing);

  /// Content of report.json, to be extended.
  nlohmann::ordered_json json;

  /// Writes report.json and report.html; prints the notes and where the results are.
  void finish(bool print_summary);

 private:
  void add_list(const std::string& title, const std::vector<std::string>& sentences);

  std::filesystem::path folder_;
  std::string title_, introduction_, body_;
  std::vector<std::string> notes_;
};

}  // namespace condyle
