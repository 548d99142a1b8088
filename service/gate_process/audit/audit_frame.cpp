// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/audit/audit_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "service/gate_process/audit/audit_bytes.hpp"
#include "surefoot/core/fnv1a.hpp"

namespace surefoot::gate_process {
namespace {

constexpr std::size_t kCheckedBytes = kFrameHeaderBytes - 4;

/// Combines both halves of the hash. This value checks the header alone, so a wrong length is never
/// used.
std::uint32_t check_of(std::string_view header) noexcept {
    const std::uint64_t hash = fnv1a(header.substr(0, kCheckedBytes));
    return static_cast<std::uint32_t>(hash ^ hash >> 32U);
}

template <typename Header, typename Visit>
void for_each_header_field(Header& header, Visit& visit) {
    visit("kind", header.kind);
    visit("encoding", header.encoding);
}
template <typename Header, typename Visit>
void for_each_header_number(Header& header, Visit& visit) {
    visit("stored_bytes", header.stored_bytes);
    visit("plain_bytes", header.plain_bytes);
    visit("sequence", header.sequence);
    visit("previous_hash", header.previous_hash);
}

template <typename Head, typename Visit>
void for_each_head_field(Head& head, Visit& visit) {
    visit("run_id", head.run_id);
    visit("number", head.number);
    visit("machine_hash", head.machine_hash);
}

template <typename Gap, typename Visit>
void for_each_gap_field(Gap& gap, Visit& visit) {
    visit("verdicts", gap.verdicts);
    visit("first_ns", gap.first_ns);
    visit("last_ns", gap.last_ns);
}

template <typename Act, typename Visit>
void for_each_act_field(Act& act, Visit& visit) {
    visit("kind", act.kind);
    visit("outcome", act.outcome);
    visit("role", act.role);
    visit("connection", act.connection);
    visit("time_ns", act.time_ns);
    visit("radius_tenth_mm", act.radius_tenth_mm);
    visit("left_out", act.left_out);
}

std::uint8_t text_bytes(const Act& act) noexcept {
    static_assert(kMaxActText_bytes <= 255);
    return static_cast<std::uint8_t>(std::min(act.text.size(), kMaxActText_bytes));
}

}  // namespace

std::uint64_t append_frame(std::string& out, const FrameHeader& header, std::string_view stored) {
    const std::size_t start = out.size();
    char fixed[kFrameHeaderBytes];
    ByteWriter writer(fixed);
    writer("magic", kFrameMagic | kFrameVersion << 24U);
    for_each_header_field(header, writer);
    writer("zero", std::uint16_t{0});
    for_each_header_number(header, writer);
    writer("check", check_of({fixed, sizeof(fixed)}));
    out.append(fixed, sizeof(fixed));
    out.append(stored);
    const std::uint64_t hash = fnv1a(std::string_view(out).substr(start));
    char tail[kFrameHashBytes];
    ByteWriter(static_cast<char*>(tail))("hash", hash);
    out.append(tail, sizeof(tail));
    return hash;
}

HeaderState parse_frame_header(std::string_view bytes, FrameHeader& header) noexcept {
    ByteReader reader(bytes);
    std::uint32_t magic = 0;
    std::uint16_t zero = 0;
    std::uint32_t check = 0;
    reader("magic", magic);
    for_each_header_field(header, reader);
    reader("zero", zero);
    for_each_header_number(header, reader);
    reader("check", check);
    if (!reader.ok()) return HeaderState::damaged;
    if ((magic & 0xffffffU) != kFrameMagic) return HeaderState::no_frame;
    if (check != check_of(bytes)) return HeaderState::damaged;
    header.version = magic >> 24U;
    if (header.version < kOldestFrameVersion || header.version > kFrameVersion)
        return HeaderState::other_version;
    const bool sound = zero == 0 && header.stored_bytes <= kMaxPayloadBytes &&
                       header.plain_bytes <= kMaxPayloadBytes;
    return sound ? HeaderState::sound : HeaderState::damaged;
}

std::string format_file_head(const FileHead& head) {
    ByteCounter counter;
    for_each_head_field(head, counter);
    std::string bytes(counter.bytes(), '\0');
    ByteWriter writer(bytes.data());
    for_each_head_field(head, writer);
    return bytes + format_machine(head.machine);
}

Status parse_file_head(std::string_view bytes, FileHead& head) {
    ByteReader reader(bytes);
    for_each_head_field(head, reader);
    if (!reader.ok()) return input_error("the head of the file is shorter than its fields");
    if (auto status = parse_machine(reader.rest(), head.machine); !status) return status;
    if (fnv1a(reader.rest()) != head.machine_hash)
        return input_error("the machine description does not match its hash");
    return {};
}

std::string format_gap(const AuditGap& gap) {
    std::string bytes(sizeof(AuditGap), '\0');
    ByteWriter writer(bytes.data());
    for_each_gap_field(gap, writer);
    return bytes;
}

Status parse_gap(std::string_view bytes, AuditGap& gap) {
    ByteReader reader(bytes);
    for_each_gap_field(gap, reader);
    if (!reader.ok() || !reader.rest().empty())
        return input_error("the gap entry does not have the length of its fields");
    return {};
}

std::size_t act_bytes(const Act& act) noexcept {
    ByteCounter counter;
    for_each_act_field(act, counter);
    return counter.bytes() + 1 + text_bytes(act);
}

void write_act(const Act& act, char* out) noexcept {
    ByteWriter writer(out);
    for_each_act_field(act, writer);
    writer("text_bytes", text_bytes(act));
    writer.copy(act.text.data(), text_bytes(act));
}

Status parse_act(std::string_view bytes, Act& act) {
    ByteReader reader(bytes);
    for_each_act_field(act, reader);
    std::uint8_t text = 0;
    reader("text_bytes", text);
    if (!reader.ok() || reader.rest().size() != text || text > kMaxActText_bytes)
        return input_error("the act entry is cut off, or the length of its text is wrong");
    if (act.kind < ActKind::connect || act.kind > ActKind::rearm ||
        act.outcome < ActOutcome::done || act.outcome > ActOutcome::no_right ||
        act.role > Role::operator_)
        return input_error(
            "the act has an unknown kind, outcome or role; read the log with the program version "
            "that "
            "wrote it");
    act.text = reader.rest();
    return {};
}

std::string audit_file_name(std::uint64_t run_id, std::uint64_t number) {
    return fmt::format("audit-{:016x}-{:08}.log", run_id, number);
}

bool parse_audit_file_name(std::string_view name, std::uint64_t& number) noexcept {
    constexpr std::string_view kFront = "audit-";
    constexpr std::string_view kBack = ".log";
    constexpr std::size_t kRunDigits = 16;
    constexpr std::size_t kNumberAt = kFront.size() + kRunDigits + 1;
    if (name.size() < kNumberAt + 8 + kBack.size() || !name.starts_with(kFront) ||
        !name.ends_with(kBack) || name[kNumberAt - 1] != '-')
        return false;
    const std::string_view run = name.substr(kFront.size(), kRunDigits);
    if (run.find_first_not_of("0123456789abcdef") != run.npos) return false;
    const char* end = name.data() + name.size() - kBack.size();
    const auto [rest, error] = std::from_chars(name.data() + kNumberAt, end, number);
    return error == std::errc{} && rest == end;
}

}  // namespace surefoot::gate_process
