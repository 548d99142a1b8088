// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/outlook.hpp"

#include <nlohmann/json.hpp>
#include <span>

#include "service/gate_process/protocol/topic_json.hpp"

namespace surefoot::gate_process {
namespace {

constexpr std::int64_t kRoundNs = 250'000'000;  // period of the rounds: 4 Hz
constexpr int kMostWaits = 4;  // number of calls; 20 ms at the service's tick of 5 ms

}  // namespace

bool OutlookRounds::gives_way(const OutlookDemand& demand) noexcept {
    gave_way_ = demand.question_waits && gave_way_ < kMostWaits ? gave_way_ + 1 : 0;
    return gave_way_ > 0;
}

bool OutlookRounds::may_begin(std::int64_t now_ns) noexcept {
    if (began_ns_ && now_ns - *began_ns_ < kRoundNs) return false;
    began_ns_ = now_ns;
    return true;
}

std::optional<TopicMessage> OutlookRounds::next(StepGate& gate,
                                                const OutlookDemand& demand,
                                                std::int64_t now_ns) {
    if (!demand.subscribed) judged_ = 0;
    if (!demand.subscribed || gives_way(demand)) return std::nullopt;
    const GateReport report = gate.report(now_ns);
    if (judged_ > 0 && report.health.state != state_) {
        judged_ = 0;
        began_ns_ = now_ns;
    } else if (judged_ == 0 && !may_begin(now_ns)) {
        return std::nullopt;
    }
    state_ = report.health.state;
    const auto movements = gate.movements();
    if (judged_ < movements.size()) {
        prospects_[judged_] = gate.prospect_of(movements[judged_], now_ns);
        ++judged_;
    }
    if (judged_ < movements.size()) return std::nullopt;
    judged_ = 0;
    const Json body = outlook_object(report, gate, std::span(prospects_).first(movements.size()));
    return TopicMessage{Topic::outlook, std::make_shared<const std::string>(dump(body))};
}

}  // namespace surefoot::gate_process
