// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/rosapi.hpp"

#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/arguments.hpp"

namespace surefoot::gate_process {
namespace {

constexpr std::string_view kNode = "/surefoot_gate";

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

/// Returns the names of the entries of a type. roslib writes a type as "pkg/Name" or
/// "pkg/msg/Name".
template <typename Entries>
Json names_of_type(const Entries& entries, std::string_view type) {
    Json names = Json::array();
    for (const auto& entry : entries) {
        if (same_type(entry.type, type)) names.push_back(entry.name);
    }
    return names;
}

/// Returns the topics that clients publish if `from_client`, otherwise all other topics.
Json topics_from(bool from_client) {
    Json names = Json::array();
    for (const auto& entry : kTopics) {
        if (entry.from_client == from_client) names.push_back(entry.name);
    }
    return names;
}

/// Returns the list of nodes: the only node if `involved`, otherwise empty.
Json node_if(bool involved) {
    return involved ? Json::array({kNode}) : Json::array();
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

Json node_details(std::string_view node) {
    if (node != kNode && node != kNode.substr(1))
        return {{"subscribing", Json::array()},
                {"publishing", Json::array()},
                {"services", Json::array()}};
    return {{"subscribing", topics_from(true)},
            {"publishing", topics_from(false)},
            {"services", names_of(kServices)}};
}

}  // namespace

Json rosapi_answer(Service service, const Json& args) {
    switch (service) {
        case Service::list_topics:
            return {{"topics", names_of(kTopics)}, {"types", types_of_topics()}};
        case Service::list_services: return {{"services", names_of(kServices)}};
        case Service::list_nodes: return {{"nodes", Json::array({kNode})}};
        case Service::topic_type: return type_object(find_topic(text_argument(args, "topic")));
        case Service::service_type:
            return type_object(find_service(text_argument(args, "service")));
        case Service::list_params: return {{"names", names_of(kParameters)}};
        case Service::list_action_servers: return {{"action_servers", Json::array()}};
        case Service::topics_for_type:
            return {{"topics", names_of_type(kTopics, text_argument(args, "type"))}};
        case Service::services_for_type:
            return {{"services", names_of_type(kServices, text_argument(args, "type"))}};
        case Service::service_node:
            return {{"node", find_service(text_argument(args, "service")) != nullptr ? kNode : ""}};
        case Service::service_providers:
            return {{"providers",
                     node_if(!names_of_type(kServices, text_argument(args, "service")).empty())}};
        case Service::publishers: {
            const TopicEntry* topic = find_topic(text_argument(args, "topic"));
            return {{"publishers", node_if(topic != nullptr && !topic->from_client)}};
        }
        case Service::subscribers: {
            const TopicEntry* topic = find_topic(text_argument(args, "topic"));
            return {{"subscribers", node_if(topic != nullptr && topic->from_client)}};
        }
        case Service::node_details: return node_details(text_argument(args, "node"));
        case Service::has_param:
            return {{"exists", param_object(text_argument(args, "name"))["successful"]}};
        case Service::get_param: return param_object(text_argument(args, "name"));
        default: return Json::object();
    }
}

}  // namespace surefoot::gate_process
