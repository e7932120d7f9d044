-- SPDX-License-Identifier: Apache-2.0
-- A fleet's server, version 1 (docs/fleet.md). `strata fleet init` runs it in one transaction.
--
-- Who may do what is decided here, by roles and row-level security, and by no program of ours:
--   a robot     adds visits under its own name; reads released versions of its own site, and of its own
--               visits which there are (number and hash, not what is in them)
--   an operator reads visits of one site; releases versions of it and takes them back; sets robots aside
--   the owner   of the tables makes sites, robots and operators
-- Nobody changes or removes a visit.
CREATE SCHEMA strata;
REVOKE ALL ON SCHEMA strata FROM PUBLIC;

-- Roles belong to the whole server, and may be there from another database.
DO $$ BEGIN CREATE ROLE strata_robot NOLOGIN; EXCEPTION WHEN duplicate_object THEN NULL; END $$;
DO $$ BEGIN CREATE ROLE strata_operator NOLOGIN; EXCEPTION WHEN duplicate_object THEN NULL; END $$;
GRANT USAGE ON SCHEMA strata TO strata_robot, strata_operator;

CREATE TABLE strata.schema_version (
  version integer PRIMARY KEY,
  applied_at timestamptz NOT NULL DEFAULT now());
INSERT INTO strata.schema_version (version) VALUES (1);
GRANT SELECT ON strata.schema_version TO strata_robot, strata_operator;

CREATE DOMAIN strata.short_name AS text CHECK (VALUE ~ '^[a-z0-9][a-z0-9_-]{0,29}$');
CREATE DOMAIN strata.sha256 AS text CHECK (VALUE ~ '^[0-9a-f]{64}$');

CREATE TABLE strata.site (
  site strata.short_name PRIMARY KEY,
  frame text NOT NULL,
  made_at timestamptz NOT NULL DEFAULT now());

CREATE TABLE strata.robot (
  site strata.short_name NOT NULL REFERENCES strata.site,
  robot strata.short_name NOT NULL,
  role_name name NOT NULL UNIQUE,
  set_aside text,  -- why its visits are not learned from; NULL: they are
  added_at timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (site, robot));

CREATE TABLE strata.operator (
  site strata.short_name NOT NULL REFERENCES strata.site,
  operator strata.short_name NOT NULL,
  role_name name NOT NULL UNIQUE,
  added_at timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (site, operator));

-- visit: when its first scan was taken, in nanoseconds since 1970, so that a robot needs no counter.
-- sha256: of what the payload holds when it is unpacked (memory/store/visit_content.hpp).
CREATE TABLE strata.visit (
  site strata.short_name NOT NULL,
  robot strata.short_name NOT NULL,
  visit bigint NOT NULL,
  sha256 strata.sha256 NOT NULL,
  format integer NOT NULL,
  scans integer NOT NULL CHECK (scans > 0),
  end_ns bigint NOT NULL,
  path_m double precision NOT NULL,
  payload bytea NOT NULL CHECK (octet_length(payload) <= 268435456),
  bytes integer GENERATED ALWAYS AS (octet_length(payload)) STORED,
  received_at timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (site, robot, visit),
  FOREIGN KEY (site, robot) REFERENCES strata.robot);
-- It is packed already.
ALTER TABLE strata.visit ALTER COLUMN payload SET STORAGE EXTERNAL;

-- runs: hashes of the visits that its maps hold, as of strata.visit: who has one of them is in the
-- frame of the site.
CREATE TABLE strata.version (
  site strata.short_name NOT NULL REFERENCES strata.site,
  hash strata.sha256 NOT NULL,
  state text NOT NULL DEFAULT 'loading' CHECK (state IN ('loading', 'released', 'withdrawn')),
  runs text[] NOT NULL,
  facts jsonb NOT NULL,
  note text NOT NULL,
  state_by name NOT NULL DEFAULT session_user,
  state_at timestamptz NOT NULL DEFAULT clock_timestamp(),
  PRIMARY KEY (site, hash));

CREATE TABLE strata.version_file (
  site strata.short_name NOT NULL,
  hash strata.sha256 NOT NULL,
  path text NOT NULL,
  part integer NOT NULL,
  payload bytea NOT NULL,
  PRIMARY KEY (site, hash, path, part),
  FOREIGN KEY (site, hash) REFERENCES strata.version);

-- Who asks. session_user is who logged in, whatever SET ROLE says.
CREATE FUNCTION strata.my_site() RETURNS text
  LANGUAGE sql STABLE SECURITY DEFINER SET search_path = pg_catalog
  AS $$ SELECT site::text FROM strata.robot WHERE role_name = session_user
        UNION ALL SELECT site::text FROM strata.operator WHERE role_name = session_user $$;
CREATE FUNCTION strata.my_robot() RETURNS text
  LANGUAGE sql STABLE SECURITY DEFINER SET search_path = pg_catalog
  AS $$ SELECT robot::text FROM strata.robot WHERE role_name = session_user $$;
-- What any version of the asker's site was ever made of, withdrawn ones too.
CREATE FUNCTION strata.known_runs() RETURNS SETOF text
  LANGUAGE sql STABLE SECURITY DEFINER SET search_path = pg_catalog
  AS $$ SELECT DISTINCT unnest(runs) FROM strata.version
        WHERE site = strata.my_site() AND state <> 'loading' $$;
REVOKE ALL ON FUNCTION strata.my_site(), strata.my_robot(), strata.known_runs() FROM PUBLIC;
GRANT EXECUTE ON FUNCTION strata.my_site(), strata.my_robot(), strata.known_runs()
  TO strata_robot, strata_operator;

-- Visits are there for ever, whoever asks.
CREATE FUNCTION strata.refuse_change() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  RAISE EXCEPTION 'visits are never changed or removed' USING ERRCODE = 'insufficient_privilege';
END $$;
CREATE TRIGGER visit_stays BEFORE UPDATE OR DELETE ON strata.visit
  FOR EACH ROW EXECUTE FUNCTION strata.refuse_change();
CREATE TRIGGER visit_stays_whole BEFORE TRUNCATE ON strata.visit
  FOR EACH STATEMENT EXECUTE FUNCTION strata.refuse_change();

-- A version that was released does not change but for its state, and who set that is written down.
CREATE FUNCTION strata.note_state() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF NEW.state = 'loading' THEN
    RAISE EXCEPTION 'a released version is not loaded again' USING ERRCODE = 'insufficient_privilege';
  END IF;
  NEW.state_by := session_user;
  NEW.state_at := clock_timestamp();
  RETURN NEW;
END $$;
CREATE TRIGGER version_state BEFORE UPDATE ON strata.version
  FOR EACH ROW EXECUTE FUNCTION strata.note_state();

ALTER TABLE strata.site ENABLE ROW LEVEL SECURITY;
ALTER TABLE strata.robot ENABLE ROW LEVEL SECURITY;
ALTER TABLE strata.operator ENABLE ROW LEVEL SECURITY;
ALTER TABLE strata.visit ENABLE ROW LEVEL SECURITY;
ALTER TABLE strata.version ENABLE ROW LEVEL SECURITY;
ALTER TABLE strata.version_file ENABLE ROW LEVEL SECURITY;

CREATE POLICY own_site ON strata.site FOR SELECT TO strata_robot, strata_operator
  USING (site = (SELECT strata.my_site()));
GRANT SELECT ON strata.site TO strata_robot, strata_operator;

-- Robots.
CREATE POLICY robot_adds ON strata.visit FOR INSERT TO strata_robot
  WITH CHECK (site = (SELECT strata.my_site()) AND robot = (SELECT strata.my_robot()));
CREATE POLICY robot_sees_own ON strata.visit FOR SELECT TO strata_robot
  USING (site = (SELECT strata.my_site()) AND robot = (SELECT strata.my_robot()));
GRANT INSERT (site, robot, visit, sha256, format, scans, end_ns, path_m, payload)
  ON strata.visit TO strata_robot;
GRANT SELECT (site, robot, visit, sha256, scans, end_ns, bytes, path_m, received_at) ON strata.visit TO strata_robot;
CREATE POLICY robot_reads_released ON strata.version FOR SELECT TO strata_robot
  USING (site = (SELECT strata.my_site()) AND state = 'released');
GRANT SELECT ON strata.version TO strata_robot;
CREATE POLICY robot_reads_released ON strata.version_file FOR SELECT TO strata_robot
  USING (site = (SELECT strata.my_site()) AND EXISTS (
    SELECT FROM strata.version AS v
    WHERE v.site = version_file.site AND v.hash = version_file.hash AND v.state = 'released'));
GRANT SELECT ON strata.version_file TO strata_robot;

-- Operators.
CREATE POLICY operator_reads ON strata.visit FOR SELECT TO strata_operator
  USING (site = (SELECT strata.my_site()));
GRANT SELECT ON strata.visit TO strata_operator;
CREATE POLICY operator_reads ON strata.robot FOR SELECT TO strata_operator
  USING (site = (SELECT strata.my_site()));
CREATE POLICY operator_sets_aside ON strata.robot FOR UPDATE TO strata_operator
  USING (site = (SELECT strata.my_site()));
GRANT SELECT, UPDATE (set_aside) ON strata.robot TO strata_operator;
CREATE POLICY operator_reads ON strata.version FOR SELECT TO strata_operator
  USING (site = (SELECT strata.my_site()));
CREATE POLICY operator_adds ON strata.version FOR INSERT TO strata_operator
  WITH CHECK (site = (SELECT strata.my_site()) AND state = 'loading');
CREATE POLICY operator_decides ON strata.version FOR UPDATE TO strata_operator
  USING (site = (SELECT strata.my_site()));
GRANT SELECT, INSERT (site, hash, runs, facts, note), UPDATE (state) ON strata.version
  TO strata_operator;
CREATE POLICY operator_reads ON strata.version_file FOR SELECT TO strata_operator
  USING (site = (SELECT strata.my_site()));
CREATE POLICY operator_adds ON strata.version_file FOR INSERT TO strata_operator
  WITH CHECK (site = (SELECT strata.my_site()) AND EXISTS (
    SELECT FROM strata.version AS v
    WHERE v.site = version_file.site AND v.hash = version_file.hash AND v.state = 'loading'));
GRANT SELECT, INSERT ON strata.version_file TO strata_operator;
