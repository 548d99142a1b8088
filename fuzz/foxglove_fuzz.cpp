// SPDX-License-Identifier: Apache-2.0
// Any bytes as messages of a Foxglove client and as news of the gate. Every text that the service
// sends is one of the three known operations. Every message belongs to a subscription. The client
// gets at most one answer per request. The first byte is the time between lines; each further line
// is one message.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "fuzz/must.hpp"
#include "service/page/foxglove_client.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::page;
using Json = nlohmann::ordered_json;

void check(const FoxgloveClient& client, const SocketMessage& message) {
    if (!message.is_text) {
        constexpr std::size_t kTimeBytes = 9;
        constexpr std::size_t kHeadBytes = 13;
        must(!message.bytes.empty());
        if (message.bytes[0] == 2) return must(message.bytes.size() == kTimeBytes);
        must(message.bytes[0] == 1 && message.bytes.size() > kHeadBytes);
        must(Json::parse(message.bytes.substr(kHeadBytes)).is_object());
        return must(std::any_of(kFoxgloveChannels.begin(),
                                kFoxgloveChannels.end(),
                                [&](FoxgloveChannel c) { return client.listens_to(c); }));
    }
    const Json text = Json::parse(message.bytes);  // throws on invalid JSON: a finding
    must(text["op"] == "serverInfo" || text["op"] == "advertise" || text["op"] == "status");
}

void hear(FoxgloveShow& show, std::string_view line) {
    auto news = read_gate_news(line);
    if (!news) return;
    must(Json::parse(news->body).is_object());
    show.hear(std::move(*news));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    Show seen;
    FoxgloveShow show(seen);
    FoxgloveClient client("fuzz", "1");
    std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
    std::int64_t now_ns = 1'000'000'000;
    for (std::size_t greeting = 2; !rest.empty(); greeting = 0) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
        const bool goes_on = client.take(line.empty() || line[0] != '\x01', line, now_ns).ok();
        hear(show, line);
        now_ns += data[0] * std::int64_t{1'000'000};
        show.observation(now_ns, std::nullopt);
        const auto messages = client.next(show, now_ns);
        const auto texts = std::count_if(
            messages.begin(), messages.end(), [](const auto& m) { return m.is_text; });
        must(static_cast<std::size_t>(texts) <= greeting + 1);
        for (const SocketMessage& message : messages) check(client, message);
        if (!goes_on) return 0;
    }
    return 0;
}
