// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "service/live/steered_walk.hpp"
#include "service/rex_link/link_client.hpp"

// These functions write the JSON objects of the command line. The names of the keys are a contract
// (docs/reference/json.md). NaN is written as null.
namespace surefoot::app {

[[nodiscard]] std::string serve_json(const std::vector<AskedStep>& steps);
/// An event of the REX link. `tone_file`: file of the tone; empty = no tone or no tone folder.
struct RexLinkRow {
    rex_link::LinkEvent event;
    std::string tone_file;
};
[[nodiscard]] std::string rex_link_json(const std::string& url,
                                        const std::vector<RexLinkRow>& rows);

}  // namespace surefoot::app
