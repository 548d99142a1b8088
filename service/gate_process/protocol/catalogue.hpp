// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace surefoot::gate_process {

/// All names of the protocol: topics and services. A name that is not in this list is not served.
enum class Topic : std::uint8_t { verdict, health, diagnostics, outlook, goal_marker, goal };

struct TopicEntry {
    Topic topic;
    std::string_view name;
    std::string_view type;
    bool from_client;  ///< true: clients publish it; false: clients subscribe to it
};

inline constexpr std::array<TopicEntry, 6> kTopics{{
    {Topic::verdict, "/surefoot/verdict", "surefoot/Verdict", false},
    {Topic::health, "/surefoot/health", "surefoot/Health", false},
    {Topic::diagnostics, "/diagnostics", "diagnostic_msgs/DiagnosticArray", false},
    {Topic::outlook, "/surefoot/outlook", "surefoot/Outlook", false},
    {Topic::goal_marker, "/surefoot/goal_marker", "visualization_msgs/Marker", false},
    {Topic::goal, "/move_base_simple/goal", "geometry_msgs/PoseStamped", true},
}};

enum class Service : std::uint8_t {
    step,
    step_forward,
    step_with_reasons,
    authenticate,
    rearm,
    attest,
    health,
    list_topics,
    list_services,
    list_nodes,
    list_params,
    list_action_servers,
    topics_for_type,
    services_for_type,
    topic_type,
    service_type,
    service_node,
    service_providers,
    publishers,
    subscribers,
    node_details,
    get_param,
    has_param
};

struct ServiceEntry {
    Service service;
    std::string_view name;
    std::string_view type;
};

inline constexpr std::array<ServiceEntry, 23> kServices{{
    {Service::step, "/step", "rex_interface/stepQuery"},
    {Service::step_forward, "/step_forward", "std_srvs/Empty"},
    {Service::step_with_reasons, "/surefoot/step", "surefoot/Step"},
    {Service::authenticate, "/surefoot/authenticate", "surefoot/Authenticate"},
    {Service::rearm, "/surefoot/rearm", "std_srvs/Trigger"},
    {Service::attest, "/surefoot/attest", "surefoot/Attest"},
    {Service::health, "/surefoot/health", "surefoot/GetHealth"},
    {Service::list_topics, "/rosapi/topics", "rosapi/Topics"},
    {Service::list_services, "/rosapi/services", "rosapi/Services"},
    {Service::list_nodes, "/rosapi/nodes", "rosapi/Nodes"},
    {Service::list_params, "/rosapi/get_param_names", "rosapi/GetParamNames"},
    {Service::list_action_servers, "/rosapi/action_servers", "rosapi/GetActionServers"},
    {Service::topics_for_type, "/rosapi/topics_for_type", "rosapi/TopicsForType"},
    {Service::services_for_type, "/rosapi/services_for_type", "rosapi/ServicesForType"},
    {Service::topic_type, "/rosapi/topic_type", "rosapi/TopicType"},
    {Service::service_type, "/rosapi/service_type", "rosapi/ServiceType"},
    {Service::service_node, "/rosapi/service_node", "rosapi/ServiceNode"},
    {Service::service_providers, "/rosapi/service_providers", "rosapi/ServiceProviders"},
    {Service::publishers, "/rosapi/publishers", "rosapi/Publishers"},
    {Service::subscribers, "/rosapi/subscribers", "rosapi/Subscribers"},
    {Service::node_details, "/rosapi/node_details", "rosapi/NodeDetails"},
    {Service::get_param, "/rosapi/get_param", "rosapi/GetParam"},
    {Service::has_param, "/rosapi/has_param", "rosapi/HasParam"},
}};

/// Returns the entry of a topic name, with or without leading slash; nullptr if unknown.
[[nodiscard]] const TopicEntry* find_topic(std::string_view name) noexcept;
[[nodiscard]] const ServiceEntry* find_service(std::string_view name) noexcept;

/// True if both names mean one type: "pkg/Name" equals "pkg/msg/Name".
[[nodiscard]] bool same_type(std::string_view ours, std::string_view theirs) noexcept;

}  // namespace surefoot::gate_process
