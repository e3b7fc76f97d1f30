// The import of a CT behind a front end: from files to choices.
#include "sim/ct_session/ct_import.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "engine/core/error.h"
#include "engine/dicom/write_ct_series.h"
#include "engine/volume/volume_files.h"
#include "sim/scanner/ct_scan.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

const Volume& scanned_head() {
  static const Volume volume = [] {
    CtSettings settings;
    settings.spacing_mm = Vector3d::Constant(2.5);
    settings.threads = 2;
    return scan_ct(ScannedHead(HeadChoice{}), settings).volume;
  }();
  return volume;
}

class CtImports : public testing::Test {
 protected:
  void SetUp() override { write_ct_series(scanned_head(), folder_ / "ct"); }
  /// Waits for the work in the background.
  void finish() {
    for (int i = 0; i < 6000 && import_.job().active() && !import_.job().done(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    import_.update();
  }
  /// Waits for the pictures of all choices.
  void draw() {
    for (int i = 0; i < 6000 && import_.drawing(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      import_.update();
    }
  }
  const CtView& view() { return *import_.view(); }
  std::string refusal_of_making(const fs::path& folder) {
    try {
      import_.begin_making(folder);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  test::Folder folder_;
  RetiredWork retired_;
  CtImport import_{retired_, [] {}, 2};
};

TEST_F(CtImports, ScansAreKnownByTheirFiles) {
  const fs::path slice = fs::directory_iterator(folder_ / "ct")->path();
  EXPECT_EQ(scan_of({fs::path(folder_ / "ct")}), fs::path(folder_ / "ct"));
  EXPECT_EQ(scan_of({slice, slice}), fs::path(folder_ / "ct"));
  EXPECT_EQ(scan_of({"head.nii.gz"}), fs::path("head.nii.gz"));
  fs::create_directories(folder_ / "empty");
  std::ofstream(folder_ / "notes.txt") << "no scan";
  EXPECT_FALSE(scan_of({fs::path(folder_ / "empty")}));
  EXPECT_FALSE(scan_of({fs::path(folder_ / "notes.txt")}));
  EXPECT_FALSE(scan_of({}));
}

TEST_F(CtImports, ListsReadsAndShowsASeries) {
  import_.open(folder_ / "ct");
  EXPECT_EQ(view().stage, CtStage::listing);
  finish();
  ASSERT_EQ(view().stage, CtStage::series);
  ASSERT_EQ(view().series.size(), 1u);
  EXPECT_EQ(view().best, 0);
  EXPECT_TRUE(view().series[0].readable);
  EXPECT_NE(view().series[0].facts.find("2.5 x 2.5 x 2.5 mm"), std::string::npos)
      << view().series[0].facts;
  EXPECT_EQ(view().name, "ct");
  EXPECT_EQ(view().case_folder, fs::path(folder_ / "ct-patient"));

  import_.read(7);  // is not in the list
  EXPECT_EQ(view().stage, CtStage::series);
  import_.read(1);
  EXPECT_EQ(view().stage, CtStage::reading);
  finish();
  ASSERT_EQ(view().stage, CtStage::slices);
  for (const CtSliceView& slice : view().slices) ASSERT_TRUE(slice.picture) << slice.name;
  ASSERT_TRUE(view().solid);
  EXPECT_GT(view().first.threshold_hu, 100);
  EXPECT_LT(view().first.threshold_hu, 500);

  // Only what a choice changes is drawn again.
  const CtView before = view();
  CtChoice choice = before.first;
  choice.turn_deg += 40;
  import_.choose(choice);
  EXPECT_EQ(view().chosen, choice) << "at once; its pictures follow";
  draw();
  EXPECT_EQ(view().slices[0].picture, before.slices[0].picture);
  EXPECT_NE(view().solid, before.solid);
  // Choices during a drawing are drawn after it, all at once.
  choice.turn_deg += 40;
  import_.choose(choice);
  choice.cross.z() += 10;
  import_.choose(choice);
  choice.cross.z() += 20;
  import_.choose(choice);
  const auto solid = view().solid;
  draw();
  EXPECT_EQ(view().slices[0].number, before.slices[0].number + 12);
  EXPECT_NE(view().solid, solid);
  choice.threshold_hu = 900;
  import_.choose(choice);
  draw();
  EXPECT_NE(view().slices[1].picture->rgba, before.slices[1].picture->rgba);

  // Pictures that are being drawn are not shown of a series that is read again.
  choice.cross.z() -= 40;
  import_.choose(choice);
  import_.read(1);
  EXPECT_FALSE(import_.drawing());
  finish();
  EXPECT_EQ(view().slices[0].number, before.slices[0].number);
  EXPECT_EQ(view().slices[0].picture->rgba, before.slices[0].picture->rgba);
}

TEST_F(CtImports, SeedsMustBeOnBoneAndTheFolderNew) {
  write_nrrd(scanned_head(), folder_ / "head.nrrd");
  import_.open(folder_ / "head.nrrd");
  EXPECT_EQ(view().case_folder, fs::path(folder_ / "head-patient"));
  finish();
  ASSERT_EQ(view().stage, CtStage::slices);
  CtChoice choice = view().first;
  const Volume& volume = scanned_head();
  choice.seeds.push_back({volume.position(0, 0, 0), true});
  import_.choose(choice);
  EXPECT_EQ(view().seed_remark.find("Seed 1: no bone above"), 0u) << view().seed_remark;
  EXPECT_NE(refusal_of_making(folder_ / "new").find("Seed 1"), std::string::npos);
  const auto bright = std::max_element(volume.values.begin(), volume.values.end());
  const auto at = static_cast<int>(bright - volume.values.begin());
  const auto [nx, ny, nz] = volume.size;
  choice.seeds[0].position = volume.position(at % nx, at / nx % ny, at / nx / ny);
  import_.choose(choice);
  EXPECT_EQ(view().seed_remark, "");
  EXPECT_NE(refusal_of_making(folder_ / "ct").find("exists already"), std::string::npos);
  EXPECT_NE(refusal_of_making(""), "");
  EXPECT_EQ(view().stage, CtStage::slices);

  const CtMaking making = import_.begin_making(folder_ / "new");
  EXPECT_TRUE(import_.making());
  EXPECT_FALSE(making.request.threshold_hu) << "that of the histogram";
  ASSERT_EQ(making.request.seeds.size(), 1u);
  EXPECT_EQ(making.request.seeds[0].label, mandible_label);
  EXPECT_EQ(making.request.name, "new");
  import_.end_making();
  EXPECT_EQ(view().stage, CtStage::slices);
  EXPECT_EQ(import_.choice(), choice) << "what was chosen stays";
}

TEST_F(CtImports, AnUnevenSeriesIsReadOnceItsSlicesMayBeInterpolated) {
  std::vector<fs::path> slices;
  for (const auto& entry : fs::directory_iterator(folder_ / "ct")) slices.push_back(entry.path());
  std::sort(slices.begin(), slices.end());
  fs::remove(slices[slices.size() / 2]);
  import_.open(folder_ / "ct");
  finish();
  ASSERT_EQ(view().series.size(), 1u);
  EXPECT_FALSE(view().series[0].readable);
  EXPECT_TRUE(view().series[0].uneven);
  ASSERT_EQ(view().series[0].remarks.size(), 1u);
  EXPECT_EQ(view().series[0].remarks[0].find("uneven: "), 0u) << view().series[0].remarks[0];
  import_.read(1);
  EXPECT_THROW(finish(), InputError);
  EXPECT_EQ(view().stage, CtStage::series);
  import_.read(1, true);
  finish();
  ASSERT_EQ(view().stage, CtStage::slices);
  EXPECT_EQ(view().slices[0].count, static_cast<int>(slices.size()));
  EXPECT_FALSE(view().volume_notes.empty());
}

TEST_F(CtImports, AVolumeOfAirIsRefusedAndTheListStays) {
  Volume air = scanned_head();
  std::fill(air.values.begin(), air.values.end(), std::int16_t{-1000});
  write_ct_series(air, folder_ / "air");
  import_.open(folder_ / "air");
  finish();
  import_.read(1);
  EXPECT_THROW(finish(), InputError);
  ASSERT_TRUE(import_.view());
  EXPECT_EQ(view().stage, CtStage::series);
  // Of a file nothing stays.
  write_nrrd(air, folder_ / "air.nrrd");
  import_.open(folder_ / "air.nrrd");
  EXPECT_THROW(finish(), InputError);
  EXPECT_FALSE(import_.view());
}

TEST_F(CtImports, WorkIsCancelled) {
  import_.open(folder_ / "ct");
  finish();
  import_.read(1);
  import_.cancel();
  EXPECT_EQ(view().stage, CtStage::series);
  EXPECT_FALSE(import_.job().active());
  import_.close();
  EXPECT_FALSE(import_.view());
}

}  // namespace
}  // namespace condyle
