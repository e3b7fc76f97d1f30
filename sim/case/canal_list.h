#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "sim/case/canal.h"
#include "sim/case/json_file.h"

namespace condyle {

/// The canals of a case.json. throws: InputError naming the wrong value.
std::vector<Canal> load_canals(const JsonItem& list, const BodyTree& bodies);
nlohmann::ordered_json canals_json(const std::vector<Canal>& canals, const BodyTree& bodies);

/// Whether canals can be saved and loaded again. throws: InputError naming folder and canal.
void check_canals(const std::vector<Canal>& canals, const BodyTree& bodies,
                  const std::filesystem::path& folder);

}  // namespace condyle
