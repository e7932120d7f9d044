// SPDX-License-Identifier: Apache-2.0
/// `strata run --check`: a composition as it would run, without running it.
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "components/runtime/component_library.hpp"
#include "components/runtime/host.hpp"
#include "tools/all_components/all_components.hpp"
#include "tools/strata/composition_options.hpp"
#include "tools/strata/explained_hosts.hpp"

namespace strata::tools {
namespace {

/// Who reads and who writes a topic, by full component name.
struct TopicUsers {
  std::vector<std::pair<std::string, runtime::TopicUse>> readers;
  std::vector<std::pair<std::string, runtime::TopicUse>> writers;
};
using Topics = std::map<std::string, TopicUsers>;

using Hosts = std::vector<std::unique_ptr<runtime::Host>>;

std::string names_of(const std::vector<std::pair<std::string, runtime::TopicUse>>& users) {
  std::string text;
  for (const auto& [name, use] : users) {
    if (text.find(name) == std::string::npos) text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

Topics collect(const Hosts& hosts) {
  Topics topics;
  for (const auto& host : hosts) {
    for (const auto& component : host->components()) {
      for (const runtime::TopicUse& use : component->topics()) {
        TopicUsers& users = topics[use.topic];
        (use.writes ? users.writers : users.readers).emplace_back(component->full_name(), use);
      }
    }
  }
  return topics;
}

std::string qos_text(const bus::QosProfile& qos) {
  std::string text = qos.reliable ? "reliable" : "best effort";
  if (qos.transient_local) text += ", latched";
  return text + (qos.depth > 0 ? ", last " + std::to_string(qos.depth) : ", all");
}

const char* start_text(runtime::Start start) {
  switch (start) {
    case runtime::Start::kInactive:
      return ", starts inactive";
    case runtime::Start::kUnconfigured:
      return ", starts unconfigured";
    case runtime::Start::kActive:
      break;
  }
  return "";
}

void print_component(const runtime::ComponentEntry& entry, const runtime::Component& component,
                     const Topics& topics) {
  std::cout << "  " << component.full_name() << "  (" << entry.type << start_text(entry.start)
            << ")\n";
  for (const bool writes : {false, true}) {
    for (const runtime::TopicUse& use : component.topics()) {
      if (use.writes != writes) continue;
      const TopicUsers& users = topics.at(use.topic);
      const std::string others = names_of(writes ? users.readers : users.writers);
      const std::string nobody = writes ? "others" : "outside";
      std::cout << "    " << (writes ? "writes " : "reads  ") << use.topic << "  " << use.type
                << "  [" << qos_text(use.qos) << "]  " << (writes ? "for " : "from ")
                << (others.empty() ? nobody : others) << '\n';
    }
  }
}

/// What became of the parameters of the node that the component stands in for.
void print_translated(const runtime::ComponentEntry& entry) {
  using Fate = runtime::TranslatedParameter::Fate;
  for (const runtime::TranslatedParameter& one : entry.translated) {
    std::cout << "    " << one.place << ": " << one.name << "  ";
    if (one.fate == Fate::kMapped) {
      std::cout << "is " << one.path << ": " << one.text;
    } else if (one.fate == Fate::kOverruled) {
      std::cout << "would be " << one.path << ": " << one.text << ", which is given otherwise";
    } else {
      std::cout << (one.fate == Fate::kUnknown ? "is unknown: " : "is left out: ") << one.text;
    }
    std::cout << '\n';
  }
}

/// What would keep two ends of a topic apart.
void print_warnings(const Topics& topics) {
  for (const auto& [topic, users] : topics) {
    for (const auto& [reader, in] : users.readers) {
      for (const auto& [writer, out] : users.writers) {
        std::string why;
        if (in.type != out.type) why = "reads " + in.type + " where it is " + out.type;
        if (in.qos.reliable && !out.qos.reliable) why = "asks for reliable and gets best effort";
        if (in.qos.transient_local && !out.qos.transient_local) {
          why = "asks for latched messages and gets none";
        }
        if (!why.empty()) {
          std::cout << "warning: " << topic << ": " << reader << " " << why << " from " << writer
                    << "; they will not connect\n";
        }
      }
    }
  }
}

}  // namespace

ExplainedHosts explained_hosts(const runtime::Composition& composition) {
  bus::ParticipantOptions alone;
  alone.domain = composition.network.domain;
  alone.transport = bus::Transport::kAlone;
  ExplainedHosts result;
  result.participant = std::make_shared<bus::Participant>(alone);
  runtime::Registry registry = all_components();
  result.libraries = runtime::load_component_libraries(composition, registry);
  runtime::HostOptions options;
  options.dry_run = true;
  for (const runtime::ProcessEntry& process : composition.processes) {
    result.hosts.push_back(std::make_unique<runtime::Host>(composition, process, registry,
                                                           result.participant, options));
  }
  return result;
}

void explain(const runtime::Composition& composition) {
  const ExplainedHosts explained = explained_hosts(composition);
  const Hosts& hosts = explained.hosts;
  const Topics topics = collect(hosts);
  std::cout << composition.place << ": domain " << composition.network.domain << ", transport "
            << bus::transport_name(composition.network.transport) << '\n';
  for (const auto& file : explained.libraries) std::cout << "library " << file.string() << '\n';
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    const runtime::ProcessEntry& process = composition.processes[i];
    const bool single = process.executor == runtime::ExecutorKind::kSingleThreaded;
    std::cout << "process " << process.name << " ("
              << (single ? "one thread for all" : "a thread for each") << ")\n";
    for (std::size_t j = 0; j < process.components.size(); ++j) {
      print_component(process.components[j], *hosts[i]->components()[j], topics);
      print_translated(process.components[j]);
    }
  }
  print_warnings(topics);
  for (const auto& host : hosts) {
    for (const std::string& error : host->take_errors()) std::cout << "warning: " << error << '\n';
  }
}

}  // namespace strata::tools
