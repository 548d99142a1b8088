// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "service/gate_process/audit/audit_disk.hpp"
#include "service/gate_process/audit/audit_reader.hpp"

namespace surefoot::gate_process::testing {

/// A folder in memory that can be full, broken, slow or blocked; shared by test and log.
struct Platter {
    std::mutex mutex;
    std::condition_variable changed;
    std::map<std::string, std::string> files;
    std::uint64_t room = std::numeric_limits<std::uint64_t>::max();  ///< limit; beyond it: ENOSPC
    std::size_t most_per_write = std::numeric_limits<std::size_t>::max();
    int write_error = 0;
    bool fails_create = false;
    bool fails_truncate = false;
    bool fails_sync = false;
    bool fails_remove = false;
    bool hangs = false;  ///< writes do not return
    int waiting = 0;     ///< number of writes that hang
    int syncs = 0;
    int creates = 0;  ///< attempts to create a file

    template <typename Change>
    void set(Change change) {
        const std::lock_guard lock(mutex);
        change(*this);
        changed.notify_all();
    }
    template <typename Condition>
    void await(Condition condition) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return condition(*this); });
    }
    [[nodiscard]] std::uint64_t used() const {
        std::uint64_t bytes = 0;
        for (const auto& [name, content] : files) bytes += content.size();
        return bytes;
    }
    /// Reads the files in order, like AuditReader.
    [[nodiscard]] AuditSummary read(AuditReader::OnVerdict on_verdict = {},
                                    AuditReader::OnAct on_act = {}) {
        const std::lock_guard lock(mutex);
        std::vector<std::pair<std::uint64_t, std::string>> order;
        for (const auto& [name, content] : files) {
            std::uint64_t number = 0;
            if (parse_audit_file_name(name, number)) order.emplace_back(number, name);
        }
        std::sort(order.begin(), order.end());
        AuditReader reader(std::move(on_verdict), std::move(on_act));
        for (const auto& [number, name] : order) reader.read(files[name], name);
        return reader.summary();
    }
};

class MemoryDisk final : public AuditDisk {
  public:
    explicit MemoryDisk(std::shared_ptr<Platter> platter) : platter_(std::move(platter)) {}

    Result<std::vector<Entry>> list() override {
        const std::lock_guard lock(platter_->mutex);
        std::vector<Entry> entries;
        for (const auto& [name, content] : platter_->files)
            entries.push_back({name, content.size()});
        return entries;
    }
    Status create(const std::string& name) override {
        const std::lock_guard lock(platter_->mutex);
        ++platter_->creates;
        if (platter_->fails_create || platter_->files.contains(name))
            return output_error(name + ": cannot be made");
        platter_->files[name] = "";
        open_ = name;
        return {};
    }
    Written write(std::string_view bytes) override {
        std::unique_lock lock(platter_->mutex);
        ++platter_->waiting;
        platter_->changed.notify_all();
        platter_->changed.wait(lock, [this] { return !platter_->hangs; });
        --platter_->waiting;
        platter_->changed.notify_all();
        if (platter_->write_error != 0) return {0, platter_->write_error};
        const std::uint64_t used = platter_->used();
        const std::uint64_t room = platter_->room > used ? platter_->room - used : 0;
        if (room == 0) return {0, ENOSPC};
        const std::size_t taken =
            std::min({bytes.size(), platter_->most_per_write, static_cast<std::size_t>(room)});
        platter_->files[open_] += bytes.substr(0, taken);
        return {taken, 0};
    }
    Status truncate(std::uint64_t bytes) override {
        const std::lock_guard lock(platter_->mutex);
        if (platter_->fails_truncate) return output_error("cannot be cut");
        platter_->files[open_].resize(bytes);
        return {};
    }
    Status sync() override {
        const std::lock_guard lock(platter_->mutex);
        ++platter_->syncs;
        platter_->changed.notify_all();
        return platter_->fails_sync ? Status(output_error("cannot be synced")) : Status();
    }
    void close() override {}
    Status remove(const std::string& name) override {
        const std::lock_guard lock(platter_->mutex);
        if (platter_->fails_remove) return output_error("cannot be removed");
        platter_->files.erase(name);
        return {};
    }

  private:
    std::shared_ptr<Platter> platter_;
    std::string open_;
};

}  // namespace surefoot::gate_process::testing
