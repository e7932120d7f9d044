-- SPDX-License-Identifier: Apache-2.0
-- What `strata fleet init` brings up to date in tables that are there, also those of an earlier Strata of
-- the same version: programs of before go on with it, so that the version stays. It may run again and again.
--
-- All of it belongs to whom the tables belong to, whoever runs it.
DO $$ BEGIN
  EXECUTE format('SET LOCAL ROLE %I',
                 (SELECT pg_get_userbyid(nspowner) FROM pg_namespace WHERE nspname = 'strata'));
END $$;

-- Robots compare spaced and coded visits by it.
GRANT SELECT (scans, end_ns) ON strata.visit TO strata_robot;

-- The runs of all versions of a site, each once: every version has those of the one before, too.
CREATE TABLE IF NOT EXISTS strata.known_run (
  site strata.short_name NOT NULL REFERENCES strata.site,
  run text NOT NULL,
  PRIMARY KEY (site, run));

-- A version that was released does not change but for its state, and who set that is written down, and when:
-- at least a second later than any before, whatever the clock says, since what was released last counts.
CREATE OR REPLACE FUNCTION strata.note_state() RETURNS trigger
  LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog AS $$
BEGIN
  IF NEW.state = 'loading' THEN
    RAISE EXCEPTION 'a released version is not loaded again' USING ERRCODE = 'insufficient_privilege';
  END IF;
  NEW.state_by := session_user;
  NEW.state_at := greatest(clock_timestamp(), (
    SELECT max(state_at) + interval '1 second' FROM strata.version
    WHERE site = NEW.site AND state <> 'loading'));
  INSERT INTO strata.known_run (site, run)
    SELECT NEW.site, run FROM unnest(NEW.runs) AS run ORDER BY run ON CONFLICT DO NOTHING;
  RETURN NEW;
END $$;
CREATE OR REPLACE TRIGGER version_state BEFORE UPDATE ON strata.version
  FOR EACH ROW EXECUTE FUNCTION strata.note_state();
INSERT INTO strata.known_run (site, run)
  SELECT DISTINCT site, unnest(runs) FROM strata.version WHERE state <> 'loading' ON CONFLICT DO NOTHING;

-- What any version of the asker's site was ever made of, withdrawn ones too. Robots of before ask for all.
CREATE OR REPLACE FUNCTION strata.known_runs() RETURNS SETOF text
  LANGUAGE sql STABLE SECURITY DEFINER SET search_path = pg_catalog
  AS $$ SELECT run FROM strata.known_run WHERE site = strata.my_site() $$;
-- ... of these.
CREATE OR REPLACE FUNCTION strata.known_runs(asked text[]) RETURNS SETOF text
  LANGUAGE sql STABLE SECURITY DEFINER SET search_path = pg_catalog
  AS $$ SELECT run FROM strata.known_run WHERE site = strata.my_site() AND run = ANY (asked) $$;
REVOKE ALL ON FUNCTION strata.known_runs(), strata.known_runs(text[]), strata.note_state() FROM PUBLIC;
GRANT EXECUTE ON FUNCTION strata.known_runs(), strata.known_runs(text[]) TO strata_robot, strata_operator;

RESET ROLE;
