// SPDX-License-Identifier: Apache-2.0
// Any bytes as an audit log give a summary, or damage with a message. The first byte chooses
// whether the bytes are a whole file or the payload of a valid frame, because the fuzzer cannot
// guess the hashes of frames. The gate decides each readable record again.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "fuzz/must.hpp"
#include "service/gate_process/audit/audit_reader.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::gate_process;

/// A machine that may only step forward.
Machine small_machine() {
    Machine m;
    m.sole_depth_tenth_mm = 9900;
    m.left_foot = {570, 1800, 3660, 1900};
    m.right_foot = {570, -1800, 3660, 1900};
    m.body.parts[0] = {{0, 0, 6600, 6450}, 1440, 20500};
    m.body.count = 1;
    m.movements[9].configured = true;
    m.movements[9].forward_tenth_mm = 4000;
    GateLimits& l = m.limits;
    l.step[0] = {true, 200, 200};
    l.patch_residual_tenth_mm = 250;
    l.patch_sigma_tenth_mm = 30;
    l.cell_sigma_tenth_mm = 120;
    l.swing_clearance_tenth_mm = 400;
    l.drop_tenth_mm = 500;
    l.drop_band_tenth_mm = 1000;
    l.drop_evidence = 128;
    l.drift_tenth_mm = 250;
    l.frame_age_ns = l.pose_age_ns = l.verdict_ttl_ns = 200'000'000;
    l.attestation_radius_tenth_mm = 10'000;
    must(m.problem() == nullptr);
    return m;
}

const FileHead& file_head() {
    static const FileHead head{1, 0, hash_of(small_machine()), small_machine()};
    return head;
}

/// A file with a valid head and one frame with this payload.
std::string framed(FrameKind kind, FrameEncoding encoding, std::string_view payload) {
    static const std::string head = format_file_head(file_head());
    const auto size = static_cast<std::uint32_t>(head.size());
    std::string file;
    FrameHeader header{FrameKind::file, FrameEncoding::plain, size, size, 0, 0};
    header.previous_hash = append_frame(file, header, head);
    header.sequence = 1;
    header.kind = kind;
    header.encoding = encoding;
    header.stored_bytes = static_cast<std::uint32_t>(payload.size());
    header.plain_bytes = encoding == FrameEncoding::plain ? header.stored_bytes : 4096;
    append_frame(file, header, payload);
    return file;
}

/// A record of the machine above. The fuzzer does not have to guess the machine's hash.
std::string own_record(std::string_view bytes) {
    std::string record(sizeof(std::uint64_t), '\0');
    std::memcpy(record.data(), &file_head().machine_hash, sizeof(std::uint64_t));
    return record += bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    AuditReader reader([](const AuditedAt& at) {
        const gate::Verdict verdict = replay(at.machine, at.record);
        static_cast<void>(differences(at.record.verdict, verdict));
        must(verdict.decision != gate::Decision::ok || at.record.snapshot_intact);
    });
    FileHead head;
    switch (data[0] % 4) {
        case 0: reader.read(bytes, "f"); break;
        case 1:
            reader.read(framed(FrameKind::verdict, FrameEncoding::plain, own_record(bytes)), "f");
            break;
        case 2: reader.read(framed(FrameKind::verdict, FrameEncoding::zstd, bytes), "f"); break;
        default:
            must_explain(parse_file_head(bytes, head));
            reader.read(framed(FrameKind::gap, FrameEncoding::plain, bytes), "f");
    }
    const auto& damage = reader.summary().damage;
    must(!damage || !damage->text().empty());
    return 0;
}
