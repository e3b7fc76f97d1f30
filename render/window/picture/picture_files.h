#pragma once

#include <filesystem>

namespace condyle {

/// Path of the next saved picture, named by the local time: condyle-20240131-140509.png, with a
/// number if that exists.
std::filesystem::path next_picture_file(const std::filesystem::path& folder);

/// The same for a folder of pictures: condyle-20240131-140509.
std::filesystem::path next_recording_folder(const std::filesystem::path& folder);

}  // namespace condyle
