// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/audit/audit_reader.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

#include "surefoot/core/fnv1a.hpp"
#include "surefoot/files/input_file.hpp"

namespace surefoot::gate_process {
namespace {

namespace fs = std::filesystem;

/// Largest size of a file that is read. It is far above the writer's limit; a larger file is an
/// error and must not fill the memory.
constexpr std::uintmax_t kMaxFileBytes = 256ULL << 20U;

bool is_zero(std::string_view bytes) noexcept {
    return bytes.find_first_not_of('\0') == bytes.npos;
}

/// True if bytes that are too short for a frame header equal the start of a header.
bool begins_like_a_frame(std::string_view bytes) noexcept {
    constexpr std::string_view kStart = "SFA";
    const std::size_t size = std::min(bytes.size(), kStart.size());
    return bytes.substr(0, size) == kStart.substr(0, size);
}

Result<std::string> whole_file(const std::string& path) {
    return files::read_file(path, kMaxFileBytes);
}

}  // namespace

std::string AuditDamage::text() const {
    const std::string frame = sequence ? fmt::format(", frame {}", *sequence) : "";
    return fmt::format("{}: byte {}{}: {}; nothing after it was read", file, offset, frame, what);
}

AuditReader::AuditReader(OnVerdict on_verdict, OnAct on_act)
    : on_verdict_(std::move(on_verdict)), on_act_(std::move(on_act)) {}

void AuditReader::read(std::string_view bytes, const std::string& file) {
    if (summary_.damage) return;
    ++summary_.files;
    summary_.bytes += bytes.size();
    file_ = file;
    offset_ = 0;
    if (bytes.empty()) end_unfinished(0, "are the whole file (it is empty)");
    while (offset_ < bytes.size()) {
        const std::string_view rest = bytes.substr(offset_);
        const std::optional<Frame> frame = next_frame(rest);
        if (!frame || !take(*frame)) return;
        link_ = {frame->header.sequence + 1, frame->hash};
        offset_ += kFrameHeaderBytes + frame->header.stored_bytes + kFrameHashBytes;
    }
}

/// Returns nothing at the end of the file or at damage, and notes the damage.
std::optional<AuditReader::Frame> AuditReader::next_frame(std::string_view rest) {
    if (is_zero(rest)) {  // space that was allocated for the file but never written
        end_unfinished(rest.size(), "are zero");
        return std::nullopt;
    }
    if (rest.size() < kFrameHeaderBytes) {
        if (begins_like_a_frame(rest))
            end_unfinished(rest.size(), "are the beginning of a frame");
        else
            damaged("no frame begins here");
        return std::nullopt;
    }
    Frame frame;
    switch (parse_frame_header(rest.substr(0, kFrameHeaderBytes), frame.header)) {
        case HeaderState::sound: break;
        case HeaderState::no_frame: damaged("no frame begins here"); return std::nullopt;
        case HeaderState::damaged:
            damaged("the header of the frame does not match its checksum");
            return std::nullopt;
        case HeaderState::other_version:
            damaged(fmt::format(
                "the frame has version {} of the format; this program reads versions {} to {}",
                static_cast<unsigned char>(rest[3]),
                kOldestFrameVersion,
                kFrameVersion));
            return std::nullopt;
    }
    const std::size_t hashed = kFrameHeaderBytes + frame.header.stored_bytes;
    if (rest.size() < hashed + kFrameHashBytes) {
        end_unfinished(rest.size(), "are the beginning of a frame");
        return std::nullopt;
    }
    std::memcpy(&frame.hash, rest.data() + hashed, kFrameHashBytes);
    if (frame.hash != fnv1a(rest.substr(0, hashed))) {
        damaged("the bytes of the frame do not match its hash", frame.header.sequence);
        return std::nullopt;
    }
    const std::string_view stored = rest.substr(kFrameHeaderBytes, frame.header.stored_bytes);
    if (!unpack(frame.header, stored, frame)) return std::nullopt;
    return frame;
}

bool AuditReader::unpack(const FrameHeader& header, std::string_view stored, Frame& frame) {
    if (header.encoding == FrameEncoding::plain) {
        frame.payload = stored;
        return stored.size() == header.plain_bytes ||
               damaged("the stored and the plain length of an uncompressed frame differ",
                       header.sequence);
    }
    if (header.encoding != FrameEncoding::zstd)
        return damaged(
            "the encoding of the frame is unknown; read the log with the program version that "
            "wrote it",
            header.sequence);
    plain_.resize(header.plain_bytes);
    const std::size_t bytes =
        ZSTD_decompress(plain_.data(), plain_.size(), stored.data(), stored.size());
    if (ZSTD_isError(bytes) != 0 || bytes != header.plain_bytes)
        return damaged("the payload of the frame cannot be unpacked", header.sequence);
    frame.payload = plain_;
    return true;
}

bool AuditReader::take(const Frame& frame) {
    const bool is_first = offset_ == 0;
    if (is_first != (frame.header.kind == FrameKind::file))
        return damaged(
            is_first ? "the file does not begin with its head" : "the file has a second head",
            frame.header.sequence);
    switch (frame.header.kind) {
        case FrameKind::file: return take_file_head(frame);
        case FrameKind::verdict: return follows(frame.header, link_) && take_verdict(frame);
        case FrameKind::gap: return follows(frame.header, link_) && take_gap(frame);
        case FrameKind::act: return follows(frame.header, link_) && take_act(frame);
    }
    return damaged(
        "the kind of the frame is unknown; read the log with the program version that wrote it",
        frame.header.sequence);
}

bool AuditReader::follows(const FrameHeader& header, const Link& link) {
    if (header.sequence != link.sequence)
        return damaged(
            fmt::format("frame {} is expected here: frames were removed, added or exchanged",
                        link.sequence),
            header.sequence);
    if (header.previous_hash != link.previous_hash)
        return damaged("the frame stores a wrong hash of the previous frame", header.sequence);
    return true;
}

/// The first file may start anywhere in the chain, because old files are removed.
bool AuditReader::take_file_head(const Frame& frame) {
    FileHead head;
    if (const Status status = parse_file_head(frame.payload, head); !status)
        return damaged(status.error().message, frame.header.sequence);
    const std::string name = fs::path(file_).filename().string();
    const std::string own_name = audit_file_name(head.run_id, head.number);
    std::uint64_t number = 0;
    if (parse_audit_file_name(name, number) && name != own_name)
        return damaged("the file was renamed: its name must be " + own_name + "; rename it back",
                       frame.header.sequence);
    if (head_ && head.number > head_->number + 1)
        return damaged(fmt::format("{} log files are missing before this file",
                                   head.number - head_->number - 1),
                       frame.header.sequence);
    const bool same_run = head_ && head.run_id == head_->run_id;
    if (same_run && !follows(frame.header, link_)) return false;
    if (head_ && !same_run && !follows(frame.header, Link{})) return false;
    if (!same_run) ++summary_.runs;
    head_ = head;
    return true;
}

bool AuditReader::take_verdict(const Frame& frame) {
    if (const Status status = parse_record(frame.payload, record_, frame.header.version); !status)
        return damaged(status.error().message, frame.header.sequence);
    if (record_.machine_hash != head_->machine_hash)
        return damaged("the verdict is for another machine than the head of the file states",
                       frame.header.sequence);
    ++summary_.verdicts;
    if (on_verdict_) on_verdict_({file_, offset_, frame.header.sequence, head_->machine, record_});
    return true;
}

bool AuditReader::take_gap(const Frame& frame) {
    AuditGap gap;
    if (const Status status = parse_gap(frame.payload, gap); !status)
        return damaged(status.error().message, frame.header.sequence);
    ++summary_.gaps;
    summary_.lost += gap.verdicts;
    return true;
}

bool AuditReader::take_act(const Frame& frame) {
    Act act;
    if (const Status status = parse_act(frame.payload, act); !status)
        return damaged(status.error().message, frame.header.sequence);
    ++summary_.acts;
    if (on_act_) on_act_(act);
    return true;
}

void AuditReader::end_unfinished(std::size_t bytes, const char* how) {
    summary_.unfinished.push_back(
        fmt::format("{}: the last {} bytes {}: the writer stopped there", file_, bytes, how));
    // A file without a head still has a number in its name.
    std::uint64_t number = 0;
    if (offset_ == 0 && head_ && parse_audit_file_name(fs::path(file_).filename().string(), number))
        head_->number = number;
}

bool AuditReader::damaged(std::string what, std::optional<std::uint64_t> sequence) {
    summary_.damage = AuditDamage{file_, offset_, sequence, std::move(what)};
    return false;
}

Result<std::vector<std::string>> audit_files_of(const std::string& path) {
    std::error_code error;
    if (!fs::is_directory(path, error)) return std::vector<std::string>{path};
    std::vector<std::pair<std::uint64_t, std::string>> found;
    for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
        std::uint64_t number = 0;
        if (parse_audit_file_name(it->path().filename().string(), number))
            found.emplace_back(number, it->path().string());
    }
    if (error) return input_error(path + ": " + error.message());
    if (found.empty()) return input_error(path + ": no audit log (audit-*.log) in this folder");
    std::sort(found.begin(), found.end());
    std::vector<std::string> files;
    files.reserve(found.size());
    for (auto& [number, file] : found) files.push_back(std::move(file));
    return files;
}

Result<AuditSummary> read_audit(const std::string& path,
                                AuditReader::OnVerdict on_verdict,
                                AuditReader::OnAct on_act) {
    const auto files = audit_files_of(path);
    if (!files) return files.error();
    AuditReader reader(std::move(on_verdict), std::move(on_act));
    for (const std::string& file : *files) {
        const auto bytes = whole_file(file);
        if (!bytes) return bytes.error();
        reader.read(*bytes, file);
    }
    return reader.summary();
}

}  // namespace surefoot::gate_process
