// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "studies/simulation/scan.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;

}  // namespace

std::string scan_json(const Scanned& scanned) {
    const Json object = {{"points", scanned.points},
                         {"stations", scanned.stations},
                         {"tiles", scanned.tiles},
                         {"complete", !scanned.error.has_value()},
                         {"error", scanned.error ? Json(scanned.error->message) : Json(nullptr)},
                         {"file", scanned.file}};
    return dump_indented(object);
}

}  // namespace surefoot::app
