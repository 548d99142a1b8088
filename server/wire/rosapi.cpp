// SPDX-License-Identifier: Apache-2.0
#include "server/wire/rosapi.hpp"

#include <nlohmann/json.hpp>

#include "server/wire/arguments.hpp"

namespace surefoot::wire {
namespace {

struct Parameter {
    std::string_view name;
    std::string_view value;  ///< JSON
};
constexpr std::array<Parameter, 2> kParameters{{
    {"/surefoot/forward_code", "9"},
    {"/surefoot/result_codes", R"({"OK":0,"NOT_TRAVERSABLE":1,"ERROR":-1})"},
}};

template <typename Entries>
Json names_of(const Entries& entries) {
    Json names = Json::array();
    for (const auto& entry : entries) names.push_back(entry.name);
    return names;
}

Json types_of_topics() {
    Json types = Json::array();
    for (const auto& entry : kTopics) types.push_back(entry.type);
    return types;
}

template <typename Entry>
Json type_object(const Entry* entry) {
    return {{"type", entry == nullptr ? "" : entry->type}};
}

Json param_object(std::string_view name) {
    for (const auto& parameter : kParameters) {
        if (parameter.name == name || parameter.name.substr(1) == name)
            return {{"value", parameter.value}, {"successful", true}, {"reason", ""}};
    }
    return {{"value", "null"}, {"successful", false}, {"reason", "no such parameter"}};
}

}  // namespace

Json rosapi_answer(Service service, const Json& args) {
    switch (service) {
        case Service::list_topics:
            return {{"topics", names_of(kTopics)}, {"types", types_of_topics()}};
        case Service::list_services: return {{"services", names_of(kServices)}};
        case Service::list_nodes: return {{"nodes", Json::array({"/surefoot_gate"})}};
        case Service::topic_type: return type_object(find_topic(text_argument(args, "topic")));
        case Service::service_type:
            return type_object(find_service(text_argument(args, "service")));
        case Service::get_param: return param_object(text_argument(args, "name"));
        default: return Json::object();
    }
}

}  // namespace surefoot::wire
