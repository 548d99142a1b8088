// SPDX-License-Identifier: Apache-2.0
// The gate on arbitrary bytes as machine, query, health and map: it must not crash, and must not
// allow a step on a map with a wrong checksum.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>

#include "fuzz/must.hpp"
#include "surefoot/gate/gate.hpp"

namespace {

/// Overwrites a value with the next bytes of the input.
class Bytes {
  public:
    Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
    void into(void* target, std::size_t size) {
        const std::size_t taken = size < size_ ? size : size_;
        std::memcpy(target, data_, taken);
        data_ += taken;
        size_ -= taken;
    }

  private:
    const std::uint8_t* data_;
    std::size_t size_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace surefoot;
    static const auto map = std::make_unique<grid::MapSnapshot>();
    Bytes bytes(data, size);
    Machine machine;
    gate::Query query;
    bytes.into(&query.command, sizeof query.command);
    bytes.into(&query.x_tenth_mm, sizeof query.x_tenth_mm);
    bytes.into(&query.y_tenth_mm, sizeof query.y_tenth_mm);
    bytes.into(&query.cos_yaw, sizeof query.cos_yaw);
    bytes.into(&query.sin_yaw, sizeof query.sin_yaw);
    std::int64_t now_ns = 0;
    bytes.into(&now_ns, sizeof now_ns);
    // Header and first cells. Half of the inputs get a valid checksum, so that the fuzzer reaches
    // the code behind it.
    std::uint8_t sealed = 0;
    bytes.into(&sealed, sizeof sealed);
    bytes.into(static_cast<void*>(&map->frame_time_ns), 128);
    if ((sealed & 1U) != 0U) grid::seal(*map);
    gate::GateHealth health;
    health.state = gate::GateState::ready;
    const gate::Verdict verdict = gate::decide(machine, query, *map, health, now_ns);
    must(verdict.decision != gate::Decision::ok);  // the default machine allows no movement
    return 0;
}
